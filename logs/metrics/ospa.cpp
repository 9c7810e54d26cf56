#include "logs/metrics/ospa.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/index.hpp"

namespace vantage::logs {

template <class Cost>
std::span<const int> OspaJudge::assign(std::size_t truths, std::size_t estimates,
                                       const Cost& cost) {
  const std::size_t rows = std::min(truths, estimates);
  const std::size_t columns = std::max(truths, estimates);
  cost_m2_.resize(rows * columns);
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      cost_m2_[r * columns + c] = truths <= estimates ? cost(r, c) : cost(c, r);
    }
  }
  return solver_.solve(cost_m2_, static_cast<int>(rows), static_cast<int>(columns));
}

SetError OspaJudge::judge(std::span<const Labelled> truth, std::span<const Labelled> estimates) {
  SetError error;
  const auto squared_m2 = [&](std::size_t i, std::size_t j) {
    return (truth[i].position_m - estimates[j].position_m).squaredNorm();
  };
  const auto cut_m2 = [&](std::size_t i, std::size_t j) {
    return std::min(cutoff_m_ * cutoff_m_, squared_m2(i, j));
  };
  const auto pair_of = [&](std::size_t row, int column) {
    const std::size_t other = index(column);
    return truth.size() <= estimates.size() ? std::pair(row, other) : std::pair(other, row);
  };
  const std::size_t most = std::max(truth.size(), estimates.size());
  const std::span<const int> best = assign(truth.size(), estimates.size(), cut_m2);
  double sum_m2 = cutoff_m_ * cutoff_m_ * static_cast<double>(most - best.size());
  for (std::size_t row = 0; row < best.size(); ++row) {
    const auto [i, j] = pair_of(row, best[row]);
    sum_m2 += cut_m2(i, j);
    if (squared_m2(i, j) < cutoff_m_ * cutoff_m_) {
      const auto [known, is_new] = tracked_as_.try_emplace(truth[i].label, estimates[j].label);
      swaps_ += !is_new && known->second != estimates[j].label ? 1 : 0;
      known->second = estimates[j].label;
    }
  }
  error.ospa_m = most == 0 ? 0.0 : std::sqrt(sum_m2 / static_cast<double>(most));
  const std::span<const int> nearest = assign(truth.size(), estimates.size(), squared_m2);
  double matched_m2 = 0.0;
  for (std::size_t row = 0; row < nearest.size(); ++row) {
    const auto [i, j] = pair_of(row, nearest[row]);
    matched_m2 += squared_m2(i, j);
  }
  error.pairs = static_cast<int>(nearest.size());
  error.matched_rmse_m = error.pairs == 0 ? 0.0 : std::sqrt(matched_m2 / error.pairs);
  return error;
}

}  // namespace vantage::logs
