#include "planner/search/candidate_grid.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace vantage::planner {
namespace {

constexpr double kRounding = 1.0 + 1e-9;  // rounds outwards

}  // namespace

CandidateGrid::CandidateGrid(int targets_max, int horizon_max)
    : cells_(index(horizon_max * kSide * kSide)), pool_(65'536 + 64 * index(targets_max)) {
  cell_m_.reserve(index(horizon_max));
  relevant_begin_.reserve(index(horizon_max) + 1);
  relevant_.reserve(index(targets_max) * index(horizon_max));
}

void CandidateGrid::reset(const BeliefTable& beliefs, const Eigen::Vector2d& start_m,
                          int horizon_steps, double reach_m, double range_max_m) {
  beliefs_ = &beliefs;
  start_m_ = start_m;
  reach_m_ = reach_m;
  far_m_ = range_max_m + reach_m;
  cell_m_.clear();
  relevant_begin_.clear();
  relevant_.clear();
  for (int t = 1; t <= horizon_steps; ++t) {
    // A query at depth t comes from at most t steps away and may consider positions one step
    // further.
    const double within_m = kRounding * (far_m_ + t * reach_m);
    cell_m_.push_back(2.0 * kRounding * t * reach_m / kSide);
    relevant_begin_.push_back(static_cast<std::uint32_t>(relevant_.size()));
    for (int m = 0; m < beliefs.target_count(); ++m) {
      if ((beliefs.mean_m(m, t).head<2>() - start_m).squaredNorm() < within_m * within_m) {
        relevant_.push_back(static_cast<std::uint16_t>(m));
      }
    }
  }
  relevant_begin_.push_back(static_cast<std::uint32_t>(relevant_.size()));
  std::fill_n(cells_.begin(), horizon_steps * kSide * kSide, Cell{});
  pool_count_ = 0;
}

std::span<const std::uint16_t> CandidateGrid::relevant(int t) const {
  const std::size_t begin = relevant_begin_[index(t) - 1];
  return {relevant_.data() + begin, relevant_begin_[index(t)] - begin};
}

bool CandidateGrid::list(const Eigen::Vector2d& centre_m, int t, Cell& cell) {
  const std::span<const std::uint16_t> all = relevant(t);
  if (pool_count_ + all.size() > pool_.size()) {
    return false;
  }
  const double within_m = kRounding * (far_m_ + std::sqrt(0.5) * cell_m_[index(t) - 1]);
  cell.begin = static_cast<std::uint32_t>(pool_count_);
  for (const std::uint16_t m : all) {
    pool_[pool_count_] = m;
    const double distance2_m2 = (beliefs_->mean_m(m, t).head<2>() - centre_m).squaredNorm();
    pool_count_ += distance2_m2 < within_m * within_m ? 1U : 0U;
  }
  cell.count = static_cast<std::uint16_t>(pool_count_ - cell.begin);
  cell.is_listed = true;
  return true;
}

std::span<const std::uint16_t> CandidateGrid::near(const Eigen::Vector2d& p_m, int t) {
  constexpr std::size_t kFewEnough = 4;  // up to this number of targets, no grid is used
  if (relevant(t).size() <= kFewEnough) {
    return relevant(t);
  }
  const double cell_m = cell_m_[index(t) - 1];
  const Eigen::Vector2d corner_m = start_m_.array() - 0.5 * kSide * cell_m;
  const double column = std::floor((p_m.x() - corner_m.x()) / cell_m);
  const double row = std::floor((p_m.y() - corner_m.y()) / cell_m);
  if (!(column >= 0.0 && column < kSide && row >= 0.0 && row < kSide)) {
    return relevant(t);  // outside the grid by rounding, or no motion
  }
  const int at = ((t - 1) * kSide + static_cast<int>(row)) * kSide + static_cast<int>(column);
  Cell& cell = cells_[index(at)];
  if (!cell.is_listed &&
      !list(corner_m + cell_m * Eigen::Vector2d(column + 0.5, row + 0.5), t, cell)) {
    return relevant(t);
  }
  return {pool_.data() + cell.begin, cell.count};
}

}  // namespace vantage::planner
