#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "planner/search/lattice_bound.hpp"

// What the best path over the lattice gathers, and which it is.

namespace vantage::planner {

// long: one sweep over the same planes.
bool LatticeBound::gather(int t) {
  const Level& level = levels_[index(t)];
  const int width = level.width();
  const bool is_last = t == horizon_ - depth_;
  const Level& next = levels_[index(is_last ? t : t + 1)];
  const std::size_t controls = ends_.size();
  // Most that follows on row j, from −reach to reach, with so many steps to rest.
  const auto onwards = [&](int n, int j, int reach, int rests, float* most) {
    const int count = 2 * reach + 1;
    if (is_last) {
      std::fill_n(most, count, 0.0F);
      return;
    }
    std::fill_n(most, count, kNever);
    for (std::size_t u = 0; u < controls; ++u) {
      const Shift& shift = shifts_[index(n + shift_turns_) * controls + u];
      const float* const from = squares_.data() + index(rests) * next.size() +
                                index(n + shift.turn + next.turns) * next.plane() +
                                (j + shift.y + next.half) * next.width() + next.half - reach +
                                shift.x;
      for (int i = 0; i < count; ++i) {
        most[i] = most[i] < from[i] ? from[i] : most[i];
      }
    }
  };
  // What follows with a step to rest is what follows with none; what is rare comes on top of that.
  const bool has_rare = waits_ > 1;
  for (int rests = has_rare ? 1 : 0; rests < waits_; ++rests) {
    for (int n = -level.turns; n <= level.turns; ++n) {
      float* const here = plane(t, rests, n);
      float* const free = rests == 1 ? plane(t, 0, n) : nullptr;
      std::fill_n(here, level.plane(), kNever);
      if (free != nullptr) {
        std::fill_n(free, level.plane(), kNever);
      }
      for (int j = -level.extent; j <= level.extent; ++j) {
        const int reach = reach_of_row(t, j);
        if (reach < 0) {
          continue;
        }
        const int count = 2 * reach + 1;
        const int first = (j + level.half) * width + level.half - reach;
        const float* const seen = looks_.data() + index(n + level.turns) * level.plane() + first;
        const float* const round = all_round_.data() + first;
        float* const most = row_.data();
        onwards(n, j, reach, std::max(0, rests - 1), most);
        for (int i = 0; i < count; ++i) {
          here[first + i] = seen[i] + round[i] + most[i];
        }
        if (free == nullptr) {
          continue;
        }
        std::copy_n(here + first, count, free + first);
        const float* const rare = rare_.data() + first;
        if (std::any_of(rare, rare + count, [](float more) { return more > 0.0F; })) {
          float* const after = rare_row_.data();
          onwards(n, j, reach, waits_ - 1, after);
          for (int i = 0; i < count; ++i) {
            const float with = seen[i] + round[i] + rare[i] + after[i];
            free[first + i] = free[first + i] < with ? with : free[first + i];
          }
        }
      }
      if (!work(level.plane() * (is_last ? 1 : controls) / kMovesANode)) {
        return false;
      }
    }
  }
  // Then the most of 2 × 2 cells, for the level before.
  for (int rests = 0; rests < waits_; ++rests) {
    for (int n = -level.turns; n <= level.turns; ++n) {
      take_squares(
          plane(t, rests, n), level,
          squares_.data() + index(rests) * level.size() + index(n + level.turns) * level.plane());
      if (!work(2 * level.plane() / kMovesANode)) {
        return false;
      }
    }
  }
  return true;
}

void LatticeBound::take_squares(const float* here, const Level& level, float* out) const {
  const int width = level.width();
  for (int j = 0; j < width; ++j) {
    const float* const a = here + j * width;
    const float* const b = j + 1 < width ? a + width : a;
    float* const row = out + j * width;
    for (int i = 0; i + 1 < width; ++i) {
      const float p = a[i] < a[i + 1] ? a[i + 1] : a[i];
      const float q = b[i] < b[i + 1] ? b[i + 1] : b[i];
      row[i] = p < q ? q : p;
    }
    row[width - 1] = a[width - 1] < b[width - 1] ? b[width - 1] : a[width - 1];
  }
}

// long: finds a step of the path, then sees what it sees.
bool LatticeBound::follow_best(float* looked) {
  const int steps = horizon_ - depth_;
  const double half_cell_m = 0.5 * cell_m_ + kEdge_m;
  int n = 0;
  int x = 0;
  int y = 0;
  int rests = 0;
  for (int t = 1; t <= steps; ++t) {
    const Level& level = levels_[index(t)];
    int best_n = 0;
    int best_x = 0;
    int best_y = 0;
    float most = 2.0F * kNever;
    for (std::size_t u = 0; u < ends_.size(); ++u) {
      const Shift& shift = shifts_[index(n + shift_turns_) * ends_.size() + u];
      for (int corner = 0; corner < (t == 1 ? 1 : 4); ++corner) {
        int to_x = x + shift.x + (corner & 1);
        int to_y = y + shift.y + (corner >> 1);
        if (t == 1) {
          const double c = std::cos(from_.yaw_rad);
          const double s = std::sin(from_.yaw_rad);
          to_x =
              static_cast<int>(std::floor((c * ends_[u].x_m - s * ends_[u].y_m) / cell_m_ + 0.5));
          to_y =
              static_cast<int>(std::floor((s * ends_[u].x_m + c * ends_[u].y_m) / cell_m_ + 0.5));
        }
        const float there = plane(
            t, rests, n + shift.turn)[(to_y + level.half) * level.width() + to_x + level.half];
        if (there > most) {
          most = there;
          best_n = n + shift.turn;
          best_x = to_x;
          best_y = to_y;
        }
      }
    }
    n = best_n;
    x = best_x;
    y = best_y;
    const int k = depth_ + t;
    const double yaw_rad = from_.yaw_rad + n * unit_rad_;
    bool is_rare = false;
    for (int m = 0; m < targets_; ++m) {
      Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
      if (told_->is_reached(m, k)) {
        const Eigen::Vector2d to_m =
            beliefs_->mean_m(m, k).head<2>() - from_.position_m() - cell_m_ * Eigen::Vector2d(x, y);
        for (const Sensor& sensor : sensors_) {
          const Look seen = look(m, k, sensor, to_m.x(), to_m.y(), half_cell_m);
          if (seen.reward > 0.0 && std::abs(wrap_to_pi(std::atan2(to_m.y(), to_m.x()) - yaw_rad)) <=
                                       seen.half_angle_rad) {
            is_rare = is_rare || seen.beside > 0.0;
            const double r_m = to_m.norm();
            const Eigen::Vector2d l =
                r_m > 0.0 ? Eigen::Vector2d(to_m / r_m) : Eigen::Vector2d::UnitX();
            M += seen.across * Eigen::Matrix2d::Identity() +
                 (seen.along - seen.across) * l * l.transpose();
          }
        }
      }
      float* const told = looked + 3 * told_->at(m, k);
      told[0] += static_cast<float>(M(0, 0));
      told[1] += static_cast<float>(M(0, 1));
      told[2] += static_cast<float>(M(1, 1));
    }
    rests = rests > 0 ? rests - 1 : is_rare ? waits_ - 1 : 0;
    if (!work(kTargetNodes)) {
      return false;
    }
  }
  return true;
}

double LatticeBound::best_first_step() {
  const Level& level = levels_[1];
  const double c = std::cos(from_.yaw_rad);
  const double s = std::sin(from_.yaw_rad);
  float most = kNever;
  for (std::size_t u = 0; u < ends_.size(); ++u) {
    const int x =
        static_cast<int>(std::floor((c * ends_[u].x_m - s * ends_[u].y_m) / cell_m_ + 0.5));
    const int y =
        static_cast<int>(std::floor((s * ends_[u].x_m + c * ends_[u].y_m) / cell_m_ + 0.5));
    most = std::max(most,
                    plane(1, 0, turns_[u].turn)[(y + level.half) * level.width() + x + level.half]);
  }
  return most;
}

}  // namespace vantage::planner
