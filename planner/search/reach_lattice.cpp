#include "planner/search/reach_lattice.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

constexpr std::size_t kPlanesMax = 2048;
constexpr std::size_t kHeadingsMax = 1024;
constexpr int kMargin = 2;  // number of cells around the reachable cells

// A unit direction. Index 0 is +x; a quarter of the number of directions is +y.
struct Direction {
  double cos = 1.0;
  double sin = 0.0;
};
template <std::size_t kCount>
std::array<Direction, kCount> directions() {
  std::array<Direction, kCount> out;
  for (std::size_t d = 0; d < kCount; ++d) {
    const double angle_rad = 2.0 * kPi * static_cast<double>(d) / static_cast<double>(kCount);
    out[d] = {std::cos(angle_rad), std::sin(angle_rad)};
  }
  return out;
}

// Returns the largest angle of which all turns are integer multiples; 0: none found.
double unit_of_turns(const SearchProblem& problem) {
  double least_rad = kInfinity;
  for (const models::UnicycleControl& control : problem.controls) {
    const double turn_rad = std::abs(control.yaw_rate_radps) * problem.step_s;
    least_rad = turn_rad > 0.0 ? std::min(least_rad, turn_rad) : least_rad;
  }
  if (!std::isfinite(least_rad)) {
    return 1.0;
  }
  constexpr double kClose = 1e-9;
  for (int parts = 1; parts <= 4; ++parts) {
    const double unit_rad = least_rad / parts;
    bool whole = true;
    for (const models::UnicycleControl& control : problem.controls) {
      const double turns = control.yaw_rate_radps * problem.step_s / unit_rad;
      whole = whole && std::abs(turns - std::round(turns)) < kClose;
    }
    if (whole) {
      return unit_rad;
    }
  }
  return 0.0;
}

}  // namespace

ReachLattice::ReachLattice(int horizon_max) {
  controls_.reserve(kMaxControls);
  turns_.reserve(kMaxControls);
  ends_.reserve(kMaxControls);
  supports_.reserve(kPlanesMax);
  for (Layout& layout : layouts_) {
    layout.planes.reserve(kPlanesMax);
    layout.levels.reserve(index(horizon_max) + 1);
    layout.shifts.reserve(kHeadingsMax * kMaxControls);
  }
}

bool ReachLattice::reset(const SearchProblem& problem) {
  if (problem.controls != controls_ || problem.step_s != step_s_ ||
      problem.horizon_steps != horizon_) {
    controls_ = problem.controls;
    step_s_ = problem.step_s;
    horizon_ = problem.horizon_steps;
    is_tabled_ = table(problem);
  }
  return is_tabled_;
}

bool ReachLattice::table(const SearchProblem& problem) {
  unit_rad_ = unit_of_turns(problem);
  turn_most_ = 0;
  step_m_ = kEdge_m;
  turns_.clear();
  ends_.clear();
  for (const models::UnicycleControl& control : problem.controls) {
    const double turns = control.yaw_rate_radps * problem.step_s / std::max(unit_rad_, 1e-9);
    turns_.push_back(unit_rad_ > 0.0 ? static_cast<int>(std::lround(turns)) : 0);
    turn_most_ = std::max(turn_most_, std::abs(turns_.back()));
    ends_.push_back(models::step_unicycle({}, control, problem.step_s));
    step_m_ = std::max(step_m_, ends_.back().position_m().norm() + kEdge_m);
  }
  most_turns_ = horizon_ * turn_most_;
  const std::size_t planes = index(horizon_ + 1) * index(most_turns_ + 1);
  if (unit_rad_ <= 0.0 || planes > kPlanesMax || index(2 * most_turns_ + 1) > kHeadingsMax) {
    return false;
  }
  reach();
  for (std::size_t i = 0; i < layouts_.size(); ++i) {
    lay_out(kCellsPerStep[i], layouts_[i]);
  }
  return true;
}

void ReachLattice::reach() {
  static const auto kWays = directions<kDirections>();
  Support nothing;
  nothing.fill(-kInfinity);
  supports_.assign(1, Support{});
  std::size_t before = 0;  // first plane of the previous level
  for (int t = 1; t <= horizon_; ++t) {
    const std::size_t first = supports_.size();
    const int turns = t * turn_most_;
    supports_.resize(first + index(2 * turns + 1), nothing);
    for (int n = -(turns - turn_most_); n <= turns - turn_most_; ++n) {
      const Support& from = supports_[before + index(n + turns - turn_most_)];
      const double c = std::cos(n * unit_rad_);
      const double s = std::sin(n * unit_rad_);
      for (std::size_t u = 0; u < ends_.size(); ++u) {
        const double x_m = c * ends_[u].x_m - s * ends_[u].y_m;
        const double y_m = s * ends_[u].x_m + c * ends_[u].y_m;
        Support& to = supports_[first + index(n + turns_[u] + turns)];
        for (std::size_t d = 0; d < kDirections; ++d) {
          to[d] = std::max(to[d], from[d] + kWays[d].cos * x_m + kWays[d].sin * y_m);
        }
      }
    }
    before = first;
  }
}

ReachLattice::Plane ReachLattice::plane_of(const Support& support, double cell_m) const {
  static const auto kWays = directions<kDirections>();
  constexpr std::size_t kQuarter = kDirections / 4;
  Plane out;
  if (support[0] == -kInfinity) {
    return out;
  }
  // A cell extends this far from its centre; includes the rounding of the positions.
  const double beyond = 0.5 + kEdge_m / cell_m;
  const auto most = [&](std::size_t d) {
    return static_cast<int>(std::floor(support[d] / cell_m + beyond));
  };
  out.low = -most(3 * kQuarter);
  out.high = most(kQuarter);
  out.left = -most(2 * kQuarter) - kMargin;
  out.bottom = out.low - kMargin;
  out.width = most(0) + kMargin - out.left + 1;
  out.height = out.high + kMargin - out.bottom + 1;
  for (std::size_t i = 0; i < 2 * kQuarter - 1; ++i) {
    const std::size_t right = (3 * kQuarter + 1 + i) % kDirections;
    const std::size_t left = kQuarter + 1 + i;
    const auto off = [&](std::size_t d) {
      return support[d] / cell_m / kWays[d].cos +
             std::copysign(beyond + 0.5 * std::abs(kWays[d].sin / kWays[d].cos), kWays[d].cos);
    };
    out.rights[i] = off(right);
    out.lefts[i] = off(left);
  }
  return out;
}

ReachLattice::Row ReachLattice::row(const Plane& plane, int j) {
  constexpr std::size_t kQuarter = kDirections / 4;
  static const auto kTans = [] {
    std::array<double, kDirections> tans;
    const auto ways = directions<kDirections>();
    std::transform(ways.begin(), ways.end(), tans.begin(),
                   [](const Direction& way) { return way.sin / way.cos; });
    return tans;
  }();
  if (j < plane.low || j > plane.high) {
    return {};
  }
  double right = plane.left + plane.width - 1 - kMargin;
  double left = plane.left + kMargin;
  for (std::size_t i = 0; i < 2 * kQuarter - 1; ++i) {
    right = std::min(right, plane.rights[i] - j * kTans[(3 * kQuarter + 1 + i) % kDirections]);
    left = std::max(left, plane.lefts[i] - j * kTans[kQuarter + 1 + i]);
  }
  return {static_cast<int>(std::ceil(left)), static_cast<int>(std::floor(right))};
}

void ReachLattice::lay_out(double ratio, Layout& out) const {
  out.cell_m = step_m_ / ratio;
  out.planes.clear();
  out.levels.assign(1, Level{});
  std::size_t plane = 1;  // index in supports_; the start is not a level
  std::size_t begin = 0;
  for (int t = 1; t <= horizon_; ++t) {
    Level level;
    level.turns = t * turn_most_;
    level.first_plane = out.planes.size();
    level.begin = begin;
    Support any;
    any.fill(-kInfinity);
    for (int n = -level.turns; n <= level.turns; ++n, ++plane) {
      out.planes.push_back(plane_of(supports_[plane], out.cell_m));
      out.planes.back().begin = level.size;
      level.size += out.planes.back().size();
      std::transform(any.begin(), any.end(), supports_[plane].begin(), any.begin(),
                     [](double a, double b) { return std::max(a, b); });
    }
    level.any = plane_of(any, out.cell_m);
    begin += level.size;
    out.levels.push_back(level);
  }
  out.shifts.clear();
  for (int n = -most_turns_; n <= most_turns_; ++n) {
    const double c = std::cos(n * unit_rad_) / out.cell_m;
    const double s = std::sin(n * unit_rad_) / out.cell_m;
    const double edge = kEdge_m / out.cell_m;
    for (const Pose2& end : ends_) {
      out.shifts.push_back({static_cast<int>(std::floor(c * end.x_m - s * end.y_m - edge)),
                            static_cast<int>(std::floor(s * end.x_m + c * end.y_m - edge))});
    }
  }
}

const ReachLattice::Layout* ReachLattice::layout(int steps, std::size_t cells_max,
                                                 std::size_t level_cells_max) const {
  for (const Layout& layout : layouts_) {
    const Level& last = layout.levels[index(steps)];
    if (last.begin + last.size <= cells_max && last.size <= level_cells_max) {
      return &layout;
    }
  }
  return nullptr;
}

}  // namespace vantage::planner
