#include "models/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// Both checks below divide trajectories into pieces of time. During a piece of length Δ, a motion
// with ‖p̈‖ ≤ a stays within a Δ²/8 of uniform motion between the ends of the piece. For an arc, a
// = |ν ω| and the bound covers the sagitta; for braking, a is the deceleration. If the bound does
// not decide a check, the piece is halved.

namespace vantage::models {
namespace {

constexpr int kHalvings = 6;

double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

// Returns the state at `elapsed_s` after the start of `segment`, which begins at `start`.
TrajectoryPoint along(const PlanSegment& segment, const Pose2& start, double elapsed_s) {
  if (segment.brake_mps2 <= 0.0) {
    return {step_unicycle(start, segment.control, elapsed_s), segment.control};
  }
  const double speed = std::abs(segment.control.speed_mps);
  const double t = std::min(elapsed_s, speed / segment.brake_mps2);
  const double travelled_m =
      sign(segment.control.speed_mps) * (speed - 0.5 * segment.brake_mps2 * t) * t;
  const double left_mps = sign(segment.control.speed_mps) * (speed - segment.brake_mps2 * t);
  return {{start.x_m + travelled_m * std::cos(start.yaw_rad),
           start.y_m + travelled_m * std::sin(start.yaw_rad), start.yaw_rad},
          {left_mps, 0.0}};
}

// Iterator over a trajectory, forward in time: the wait before the start, the segments, the final
// hover. Times are seconds after the start of the iteration.
class Walker {
 public:
  Walker(const Trajectory& trajectory, Time from)
      : trajectory_(trajectory),
        piece_start_(trajectory.start),
        piece_end_s_(to_seconds(trajectory.start_time - from)) {
    advance_to(0.0);
  }

  // Advances to the piece that contains `t_s` or begins at it. Never moves backward in time.
  void advance_to(double t_s) {
    while (piece_end_s_ <= t_s) {
      const std::size_t next = next_segment_;
      if (segment_ != nullptr) {
        piece_start_ = along(*segment_, piece_start_, segment_->duration_s).world_from_body;
      }
      piece_start_s_ = piece_end_s_;
      if (next == trajectory_.segments.size()) {
        segment_ = nullptr;
        piece_end_s_ = std::numeric_limits<double>::infinity();
      } else {
        segment_ = &trajectory_.segments[next];
        piece_end_s_ += std::max(0.0, segment_->duration_s);
        ++next_segment_;
      }
    }
  }
  // Returns the position at `t_s`, which must be in the current piece or at its end.
  [[nodiscard]] Eigen::Vector2d position_m(double t_s) const {
    return (segment_ == nullptr
                ? piece_start_
                : along(*segment_, piece_start_, t_s - piece_start_s_).world_from_body)
        .position_m();
  }
  [[nodiscard]] double piece_end_s() const { return piece_end_s_; }
  [[nodiscard]] bool is_stationary() const { return segment_ == nullptr; }
  [[nodiscard]] double acceleration_mps2() const {
    if (segment_ == nullptr) {
      return 0.0;
    }
    return segment_->brake_mps2 > 0.0
               ? segment_->brake_mps2
               : std::abs(segment_->control.speed_mps * segment_->control.yaw_rate_radps);
  }

 private:
  const Trajectory& trajectory_;
  const PlanSegment* segment_ = nullptr;  // nullptr: stationary, before the start or after the end
  std::size_t next_segment_ = 0;
  Pose2 piece_start_;
  double piece_start_s_ = 0.0;
  double piece_end_s_;
};

double deviation_m(const Walker& walker, double duration_s) {
  return walker.acceleration_mps2() * duration_s * duration_s / 8.0;
}

Eigen::Vector3d at_height(const Eigen::Vector2d& p_m, double height_m) {
  return {p_m.x(), p_m.y(), height_m};
}

bool separate(const Walker& a, const Walker& b, double height_difference_m, double t0_s,
              double t1_s, double separation_m, int halvings_left) {
  const double nearest_m =
      closest_approach_m(at_height(a.position_m(t0_s), height_difference_m),
                         at_height(a.position_m(t1_s), height_difference_m),
                         at_height(b.position_m(t0_s), 0.0), at_height(b.position_m(t1_s), 0.0));
  const double slack_m = deviation_m(a, t1_s - t0_s) + deviation_m(b, t1_s - t0_s);
  if (nearest_m - slack_m >= separation_m) {
    return true;
  }
  if (nearest_m + slack_m < separation_m || halvings_left == 0 || slack_m == 0.0) {
    return false;
  }
  const double middle_s = 0.5 * (t0_s + t1_s);
  return separate(a, b, height_difference_m, t0_s, middle_s, separation_m, halvings_left - 1) &&
         separate(a, b, height_difference_m, middle_s, t1_s, separation_m, halvings_left - 1);
}

bool sweeps_clear(const World& world, const Walker& walker, double t0_s, double t1_s,
                  double radius_m, int halvings_left) {
  const double clear_m = swept_clearance_m(world, walker.position_m(t0_s), walker.position_m(t1_s));
  const double slack_m = deviation_m(walker, t1_s - t0_s);
  if (clear_m - slack_m > radius_m) {
    return true;
  }
  if (clear_m + slack_m <= radius_m || halvings_left == 0 || slack_m == 0.0) {
    return false;
  }
  const double middle_s = 0.5 * (t0_s + t1_s);
  return sweeps_clear(world, walker, t0_s, middle_s, radius_m, halvings_left - 1) &&
         sweeps_clear(world, walker, middle_s, t1_s, radius_m, halvings_left - 1);
}

}  // namespace

TrajectoryPoint at(const Trajectory& trajectory, Time time) {
  if (time < trajectory.start_time) {
    return {trajectory.start, {}};
  }
  const bool ended = time >= end_time(trajectory);
  double left_s = to_seconds(time - trajectory.start_time);
  Pose2 pose = trajectory.start;
  for (const PlanSegment& segment : trajectory.segments) {
    const double duration_s = std::max(0.0, segment.duration_s);
    if (!ended && left_s < duration_s) {
      return along(segment, pose, left_s);
    }
    pose = along(segment, pose, duration_s).world_from_body;
    left_s -= duration_s;
  }
  return {pose, {}};
}

Time end_time(const Trajectory& trajectory) {
  double duration_s = 0.0;
  for (const PlanSegment& segment : trajectory.segments) {
    duration_s += std::max(0.0, segment.duration_s);
  }
  return trajectory.start_time + from_seconds(duration_s);
}

double length_at_most_m(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (const PlanSegment& segment : trajectory.segments) {
    length_m += std::abs(segment.control.speed_mps) * std::max(0.0, segment.duration_s);
  }
  return length_m;
}

std::vector<PlanSegment> brake(double speed_mps, double brake_mps2) {
  if (speed_mps == 0.0) {
    return {};
  }
  return {{{speed_mps, 0.0}, std::abs(speed_mps) / brake_mps2, brake_mps2}};
}

bool keeps_separation(const Trajectory& a, const Trajectory& b, Time from, double separation_m,
                      double piece_s, bool ignore_height) {
  constexpr double kSlack_m = 1.0;  // arcs deviate from straight pieces by centimetres only
  if ((a.start.position_m() - b.start.position_m()).norm() >
      length_at_most_m(a) + length_at_most_m(b) + separation_m + kSlack_m) {
    return true;  // too far apart at all times: the usual case in a large team
  }
  Walker walk_a(a, from);
  Walker walk_b(b, from);
  const double height_difference_m = ignore_height ? 0.0 : a.height_m - b.height_m;
  for (double t_s = 0.0;;) {
    const double change_s = std::min(walk_a.piece_end_s(), walk_b.piece_end_s());
    if (std::isinf(change_s)) {  // both robots hover from now on
      return separate(walk_a, walk_b, height_difference_m, t_s, t_s, separation_m, 0);
    }
    const bool both_rest = walk_a.is_stationary() && walk_b.is_stationary();
    const double next_s = both_rest ? change_s : std::min(change_s, t_s + piece_s);
    if (!separate(walk_a, walk_b, height_difference_m, t_s, next_s, separation_m, kHalvings)) {
      return false;
    }
    walk_a.advance_to(next_s);
    walk_b.advance_to(next_s);
    t_s = next_s;
  }
}

bool is_clear(const World& world, const Trajectory& trajectory, Time from, double radius_m,
              double piece_s) {
  Walker walker(trajectory, from);
  for (double t_s = 0.0;;) {
    if (std::isinf(walker.piece_end_s())) {
      return sweeps_clear(world, walker, t_s, t_s, radius_m, 0);
    }
    const double next_s = walker.is_stationary() ? walker.piece_end_s()
                                                 : std::min(walker.piece_end_s(), t_s + piece_s);
    if (!sweeps_clear(world, walker, t_s, next_s, radius_m, kHalvings)) {
      return false;
    }
    walker.advance_to(next_s);
    t_s = next_s;
  }
}

}  // namespace vantage::models
