#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "planner/search/lattice_bound.hpp"

// Finds the gain of the best path over the lattice, and the path itself.

namespace vantage::planner {

void LatticeBound::find_successor_maxima(int t, int n, int j, ReachLattice::Row row, int pause_left,
                                         float* most) const {
  const int count = row.right - row.left + 1;
  if (t == horizon_ - depth_) {
    std::fill_n(most, count, 0.0F);
    return;
  }
  std::fill_n(most, count, kNever);
  const float* const squares =
      squares_.data() + index(pause_left) * layout_->levels[index(t) + 1].size;
  for (std::size_t u = 0; u < reach_.ends().size(); ++u) {
    const ReachLattice::Shift& shift = reach_.shift(*layout_, n, u);
    const ReachLattice::Plane& next = layout_->plane(t + 1, n + reach_.turn(u));
    const float* const from = squares + next.begin + next.at(row.left + shift.x, j + shift.y);
    for (int i = 0; i < count; ++i) {
      most[i] = most[i] < from[i] ? from[i] : most[i];
    }
  }
}

// Long function: it makes one sweep, in which all parts use the same planes.
bool LatticeBound::gather(int t) {
  const ReachLattice::Level& level = layout_->levels[index(t)];
  const std::size_t controls = reach_.ends().size();
  // One pause step left gives the same gain as no pause step left without a rare gain in this step,
  // so both are computed together. With no pause step left, the larger of this gain and the gain
  // with a rare gain counts.
  const bool has_rare = pause_steps_ > 1;
  for (int pause_left = has_rare ? 1 : 0; pause_left < pause_steps_; ++pause_left) {
    for (int n = -level.turns; n <= level.turns; ++n) {
      const ReachLattice::Plane& plane = layout_->plane(t, n);
      float* const here = states_.data() + begin_of(t, pause_left, n);
      float* const free = pause_left == 1 ? states_.data() + begin_of(t, 0, n) : nullptr;
      std::fill_n(here, plane.size(), kNever);
      if (free != nullptr) {
        std::fill_n(free, plane.size(), kNever);
      }
      for (int j = plane.low; j <= plane.high; ++j) {
        const ReachLattice::Row row = ReachLattice::row(plane, j);
        const int count = row.right - row.left + 1;
        if (count <= 0) {
          continue;
        }
        const std::ptrdiff_t first = plane.at(row.left, j);
        const float* const seen = looks_.data() + plane.begin + first;
        const float* const round = all_round_.data() + level.any.at(row.left, j);
        float* const most = row_.data();
        find_successor_maxima(t, n, j, row, std::max(0, pause_left - 1), most);
        for (int i = 0; i < count; ++i) {
          here[first + i] = seen[i] + round[i] + most[i];
        }
        if (free == nullptr) {
          continue;
        }
        std::copy_n(here + first, count, free + first);
        const float* const rare = rare_.data() + level.any.at(row.left, j);
        if (std::any_of(rare, rare + count, [](float more) { return more > 0.0F; })) {
          float* const after = rare_row_.data();
          find_successor_maxima(t, n, j, row, pause_steps_ - 1, after);
          for (int i = 0; i < count; ++i) {
            const float with = seen[i] + round[i] + rare[i] + after[i];
            free[first + i] = free[first + i] < with ? with : free[first + i];
          }
        }
      }
      if (!work(plane.size() * (t == horizon_ - depth_ ? 1 : controls) / kMovesANode)) {
        return false;
      }
    }
  }
  // Maxima of 2 × 2 cells, for the previous level.
  for (int pause_left = 0; pause_left < pause_steps_; ++pause_left) {
    for (int n = -level.turns; n <= level.turns; ++n) {
      const ReachLattice::Plane& plane = layout_->plane(t, n);
      find_square_maxima(states_.data() + begin_of(t, pause_left, n), plane,
                         squares_.data() + index(pause_left) * level.size + plane.begin);
      if (!work(2 * plane.size() / kMovesANode)) {
        return false;
      }
    }
  }
  return true;
}

void LatticeBound::find_square_maxima(const float* here, const ReachLattice::Plane& plane,
                                      float* out) {
  const int width = plane.width;
  for (int j = 0; j < plane.height; ++j) {
    const float* const a = here + j * width;
    const float* const b = j + 1 < plane.height ? a + width : a;
    float* const row = out + j * width;
    for (int i = 0; i + 1 < width; ++i) {
      const float p = a[i] < a[i + 1] ? a[i + 1] : a[i];
      const float q = b[i] < b[i + 1] ? b[i + 1] : b[i];
      row[i] = p < q ? q : p;
    }
    row[width - 1] = a[width - 1] < b[width - 1] ? b[width - 1] : a[width - 1];
  }
}

ReachLattice::Shift LatticeBound::first_cell(std::size_t control) const {
  const Pose2& end = reach_.ends()[control];
  return {static_cast<int>(std::floor(end.x_m / layout_->cell_m + 0.5)),
          static_cast<int>(std::floor(end.y_m / layout_->cell_m + 0.5))};
}

// Long function: it finds each step of the path, then the measurements of this step.
bool LatticeBound::follow_best(float* path_information) {
  const int steps = horizon_ - depth_;
  const double half_cell_m = 0.5 * layout_->cell_m + ReachLattice::kEdge_m;
  const Eigen::Rotation2Dd world_from_body(from_.yaw_rad);
  int n = 0;
  ReachLattice::Shift cell;
  int pause_left = 0;
  for (int t = 1; t <= steps; ++t) {
    int best_n = 0;
    ReachLattice::Shift best_cell;
    float most = 2.0F * kNever;
    for (std::size_t u = 0; u < reach_.ends().size(); ++u) {
      const ReachLattice::Shift& shift = reach_.shift(*layout_, n, u);
      const int to_n = n + reach_.turn(u);
      const float* const there = states_.data() + begin_of(t, pause_left, to_n);
      for (int corner = 0; corner < (t == 1 ? 1 : 4); ++corner) {
        const ReachLattice::Shift to = t == 1
                                           ? first_cell(u)
                                           : ReachLattice::Shift{cell.x + shift.x + (corner & 1),
                                                                 cell.y + shift.y + (corner >> 1)};
        const float gained = there[layout_->plane(t, to_n).at(to.x, to.y)];
        if (gained > most) {
          most = gained;
          best_n = to_n;
          best_cell = to;
        }
      }
    }
    n = best_n;
    cell = best_cell;
    const int k = depth_ + t;
    bool is_rare = false;
    for (int m = 0; m < targets_; ++m) {
      if (!query_cost_->is_reached(m, k)) {
        continue;
      }
      const LocalGradient local_gradient = this->local_gradient(m, k);
      const Eigen::Vector2d to_m =
          local_gradient.at_m - layout_->cell_m * Eigen::Vector2d(cell.x, cell.y);
      Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
      for (const Sensor& sensor : sensors_) {
        const CellGain seen = cell_gain(local_gradient, sensor, to_m.x(), to_m.y(), half_cell_m);
        if (seen.reward > 0.0 &&
            std::abs(wrap_to_pi(std::atan2(to_m.y(), to_m.x()) - n * reach_.unit_rad())) <=
                seen.half_angle_rad) {
          is_rare = is_rare || seen.near_gain > 0.0;
          const double r_m = to_m.norm();
          const Eigen::Vector2d l = world_from_body * (r_m > 0.0 ? Eigen::Vector2d(to_m / r_m)
                                                                 : Eigen::Vector2d::UnitX());
          M += seen.across * Eigen::Matrix2d::Identity() +
               (seen.along - seen.across) * l * l.transpose();
        }
      }
      float* const information_out = path_information + 3 * query_cost_->at(m, k);
      information_out[0] += static_cast<float>(M(0, 0));
      information_out[1] += static_cast<float>(M(0, 1));
      information_out[2] += static_cast<float>(M(1, 1));
    }
    pause_left = pause_left > 0 ? pause_left - 1 : is_rare ? pause_steps_ - 1 : 0;
    if (!work(kTargetNodes)) {
      return false;
    }
  }
  return true;
}

double LatticeBound::best_first_step() const {
  float most = kNever;
  for (std::size_t u = 0; u < reach_.ends().size(); ++u) {
    const int n = reach_.turn(u);
    const ReachLattice::Shift to = first_cell(u);
    most = std::max(most, states_[begin_of(1, 0, n) + index(layout_->plane(1, n).at(to.x, to.y))]);
  }
  return most;
}

}  // namespace vantage::planner
