#include "planner/problem/motion_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace vantage::planner {
namespace {

// Returns an upper bound of the height of a circular arc over its chord, for an arc of `length_m`
// turning by `angle_rad`.
double sagitta_of(double length_m, double angle_rad) {
  return 0.125 * length_m * std::abs(angle_rad);  // r(1 − cos(a/2)) ≤ r a²/8
}

// Position error due to times rounded to whole microseconds: 0.5 µs at up to 20 m/s.
constexpr double kClockRounding_m = 1e-5;

// Allowance for rounding in the arithmetic around the proven bounds.
constexpr double kChordSlack = 1.0 + 1e-6;

// Returns an upper bound of the deviation of `trajectory`, at any time between `from_s` and `to_s`,
// from uniform motion between its positions at these times. Let Δ be the duration. An acceleration
// of at most a contributes a Δ²/8. A velocity jump J after the share s of the duration contributes
// J s (1 − s) Δ. The deviation is linear in the velocity, so the contributions add.
double piece_slack_m(const models::Trajectory& trajectory, double from_s, double to_s) {
  const double duration_s = to_s - from_s;
  double acceleration_mps2 = 0.0;
  double kinks_m = 0.0;
  double speed_mps = 0.0;  // stationary before the start
  double begin_s = 0.0;
  const auto jump_to = [&](double next_mps, double at_s) {
    if (at_s >= from_s && at_s <= to_s) {
      kinks_m += std::abs(next_mps - speed_mps) * (at_s - from_s) * (to_s - at_s) / duration_s;
    }
  };
  for (const models::PlanSegment& segment : trajectory.segments) {
    const double end_s = begin_s + std::max(0.0, segment.duration_s);
    jump_to(segment.control.speed_mps, begin_s);
    const bool brakes = segment.brake_mps2 > 0.0;
    if (begin_s < to_s && end_s > from_s) {
      acceleration_mps2 =
          std::max(acceleration_mps2,
                   brakes ? segment.brake_mps2
                          : std::abs(segment.control.speed_mps * segment.control.yaw_rate_radps));
    }
    const double slower_mps = brakes ? std::max(0.0, std::abs(segment.control.speed_mps) -
                                                         segment.brake_mps2 * (end_s - begin_s))
                                     : std::abs(segment.control.speed_mps);
    speed_mps = std::copysign(slower_mps, segment.control.speed_mps);
    begin_s = end_s;
  }
  jump_to(0.0, begin_s);  // the vehicle then hovers
  return kChordSlack * (0.125 * acceleration_mps2 * duration_s * duration_s + kinks_m);
}

}  // namespace

MotionTable::MotionTable(int controls_max, int steps_max, int teammates_max) {
  const auto teammates = static_cast<std::size_t>(teammates_max);
  const std::size_t steps = static_cast<std::size_t>(steps_max) * teammates;
  primitives_.reserve(static_cast<std::size_t>(controls_max));
  teammate_pieces_.reserve(steps * kPieces);
  step_distances_m_.reserve(steps);
  required_m_.reserve(teammates);
}

// Long function: it fills several tables in turn.
void MotionTable::reset(const SearchProblem& problem) {
  problem_ = &problem;
  primitives_.clear();
  reach_m_ = 0.0;
  const double piece_s = problem.step_s / kPieces;
  for (const models::UnicycleControl& control : problem.controls) {
    Primitive p;
    p.control = control;
    p.end = models::step_unicycle({}, control, problem.step_s);
    for (int k = 0; k < kPieces; ++k) {
      p.piece_end_m[k] = models::step_unicycle({}, control, (k + 1) * piece_s).position_m();
    }
    for (int k = 0; k < kParts; ++k) {
      p.along[k] = models::step_unicycle({}, control, problem.step_s * k / kParts);
    }
    p.length_m = std::abs(control.speed_mps) * problem.step_s;
    p.sagitta_m = kChordSlack * sagitta_of(p.length_m / kPieces, control.yaw_rate_radps * piece_s);
    reach_m_ = std::max(reach_m_, p.length_m);
    const std::size_t at = primitives_.size();
    ends_.x_m[at] = p.end.x_m;
    ends_.y_m[at] = p.end.y_m;
    ends_.cos_yaw[at] = std::cos(p.end.yaw_rad);
    ends_.sin_yaw[at] = std::sin(p.end.yaw_rad);
    primitives_.push_back(p);
  }
  ends_.count = control_count();

  teammate_pieces_.clear();
  step_distances_m_.clear();
  required_m_.clear();
  for (std::size_t i = 0; i < problem.teammates.size(); ++i) {
    required_m_.push_back(required_separation_m(problem, i));
  }
  int steps = problem.horizon_steps + 1;
  for (const models::Trajectory& teammate : problem.teammates) {
    const double left_s = to_seconds(models::end_time(teammate) - problem.start_time);
    steps = std::max(steps, static_cast<int>(std::ceil(left_s / problem.step_s)) + 1);
  }
  if (problem.brake_mps2 > 0.0) {  // this robot's last stop may end later
    const double speed_mps = std::max(reach_m_ / problem.step_s, problem.start_speed_mps);
    steps += static_cast<int>(std::ceil(speed_mps / problem.brake_mps2 / problem.step_s));
  }
  pieces_each_ = steps * kPieces;
  for (const models::Trajectory& teammate : problem.teammates) {
    const double since_start_s = to_seconds(problem.start_time - teammate.start_time);
    const double height_m = separation_height_m(problem, teammate);
    for (int depth = 0; depth < steps; ++depth) {
      double way_m = 0.0;
      for (int k = 0; k < kPieces; ++k) {
        const double from_s = depth * problem.step_s + k * piece_s;
        const auto a = models::at(teammate, problem.start_time + from_seconds(from_s));
        const auto b = models::at(teammate, problem.start_time + from_seconds(from_s + piece_s));
        TeammatePiece piece;
        piece.from_m << a.world_from_body.position_m(), height_m;
        piece.to_m << b.world_from_body.position_m(), height_m;
        piece.slack_m =
            piece_slack_m(teammate, since_start_s + from_s, since_start_s + from_s + piece_s) +
            kClockRounding_m;
        way_m += (piece.to_m - piece.from_m).norm() + 2.0 * piece.slack_m;
        teammate_pieces_.push_back(piece);
      }
      step_distances_m_.push_back(way_m);
    }
  }
}

void MotionTable::children(const Pose2& from, double cos_yaw, double sin_yaw, Views& out) const {
  out.count = ends_.count;
  for (int at = 0; at < ends_.count; at += kLanes) {
    const Lanes x = load(ends_.x_m + at);
    const Lanes y = load(ends_.y_m + at);
    const Lanes c = load(ends_.cos_yaw + at);
    const Lanes s = load(ends_.sin_yaw + at);
    store(out.x_m + at, from.x_m + cos_yaw * x - sin_yaw * y);
    store(out.y_m + at, from.y_m + sin_yaw * x + cos_yaw * y);
    store(out.cos_yaw + at, cos_yaw * c - sin_yaw * s);
    store(out.sin_yaw + at, sin_yaw * c + cos_yaw * s);
  }
}

bool MotionTable::is_open_space(const Eigen::Vector2d& p_m) const {
  return problem_->world == nullptr ||
         (problem_->field != nullptr &&
          problem_->field->lower_bound_m(p_m) > problem_->clearance_m + reach_m_);
}

bool MotionTable::is_free(const Pose2& from, double cos_yaw, double sin_yaw, int c,
                          int depth) const {
  const Primitive& primitive = primitives_[index(c)];
  if (!is_open_space(from.position_m()) &&
      !(problem_->field != nullptr ? is_clear(from, cos_yaw, sin_yaw, primitive, 0, kParts)
                                   : arc_is_clear(*problem_->world, from, primitive.control,
                                                  problem_->step_s, problem_->clearance_m))) {
    return false;
  }
  return problem_->teammates.empty() || is_apart(from, cos_yaw, sin_yaw, primitive, depth);
}

bool MotionTable::is_clear(const Pose2& from, double cos_yaw, double sin_yaw,
                           const Primitive& primitive, int begin, int end) const {
  constexpr double kOutside_m = -1.0;  // field value outside the bounds
  constexpr double kRounding = 1e-6;   // allowance: field values are rounded down
  constexpr double kSlack_m = 1e-4;
  const models::DistanceField& field = *problem_->field;
  const int middle = (begin + end) / 2;
  const Pose2& m = primitive.along[middle];
  const double half_m = 0.5 * primitive.length_m * (end - begin) / kParts;
  const double at_least_m = field.lower_bound_m(
      {from.x_m + cos_yaw * m.x_m - sin_yaw * m.y_m, from.y_m + sin_yaw * m.x_m + cos_yaw * m.y_m});
  if (at_least_m > problem_->clearance_m + (1.0 + kRounding) * half_m + kRounding) {
    return true;
  }
  // The true distance is at most one cell diagonal more: the field holds the value at a cell's
  // centre, at most half a diagonal away.
  const double at_most_m = at_least_m + std::sqrt(2.0) * field.geometry().resolution_m;
  if (at_least_m != kOutside_m && at_most_m < problem_->clearance_m - kSlack_m) {
    return false;
  }
  if (end - begin == 2) {
    return arc_is_clear(*problem_->world, from * primitive.along[begin], primitive.control,
                        problem_->step_s * (end - begin) / kParts, problem_->clearance_m);
  }
  return is_clear(from, cos_yaw, sin_yaw, primitive, begin, middle) &&
         is_clear(from, cos_yaw, sin_yaw, primitive, middle, end);
}

bool MotionTable::is_apart(const Pose2& from, double cos_yaw, double sin_yaw,
                           const Primitive& primitive, int depth) const {
  const Eigen::Vector3d start(from.x_m, from.y_m, problem_->height_m);
  for (std::size_t i = 0; i < problem_->teammates.size(); ++i) {
    const TeammatePiece* pieces =
        &teammate_pieces_[i * index(pieces_each_) + index(depth * kPieces)];
    // Skips a teammate that is too far away to meet within one step. far_m includes the distances
    // that both robots can cover.
    const double far_m = required_m_[i] + primitive.length_m +
                         step_distances_m_[i * index(pieces_each_ / kPieces) + index(depth)];
    if ((pieces[0].from_m - start).squaredNorm() > far_m * far_m) {
      continue;
    }
    Eigen::Vector3d a = start;
    for (int k = 0; k < kPieces; ++k) {
      const Eigen::Vector2d& p = primitive.piece_end_m[k];
      const Eigen::Vector3d b(from.x_m + cos_yaw * p.x() - sin_yaw * p.y(),
                              from.y_m + sin_yaw * p.x() + cos_yaw * p.y(), problem_->height_m);
      const double nearest_m = models::closest_approach_m(a, b, pieces[k].from_m, pieces[k].to_m) -
                               primitive.sagitta_m - pieces[k].slack_m;
      if (nearest_m < required_m_[i]) {
        return false;
      }
      a = b;
    }
  }
  return true;
}

bool MotionTable::can_stop_at(const Pose2& at, double speed_mps, int depth) const {
  if (problem_->brake_mps2 <= 0.0) {
    return true;
  }
  const double stop_s = speed_mps / problem_->brake_mps2;
  const double way_m = 0.5 * speed_mps * stop_s;
  if (problem_->world != nullptr &&
      !arc_is_clear(*problem_->world, at, {way_m, 0.0}, 1.0, problem_->clearance_m)) {
    return false;
  }
  // Checks the stop and the hover against the teammates' remaining motion. The teammates' tables
  // extend until all of them hover.
  const double piece_s = problem_->step_s / kPieces;
  const double slack_m = 0.125 * problem_->brake_mps2 * piece_s * piece_s;
  const double cos_yaw = std::cos(at.yaw_rad);
  const double sin_yaw = std::sin(at.yaw_rad);
  const auto along = [&](double s) {
    const double t = std::min(s, stop_s);
    const double d = speed_mps * t - 0.5 * problem_->brake_mps2 * t * t;
    return Eigen::Vector3d(at.x_m + cos_yaw * d, at.y_m + sin_yaw * d, problem_->height_m);
  };
  for (std::size_t i = 0; i < problem_->teammates.size(); ++i) {
    const TeammatePiece* pieces = &teammate_pieces_[i * index(pieces_each_)];
    Eigen::Vector3d a = along(0.0);
    int since = 0;
    for (int k = depth * kPieces; k < pieces_each_; ++k) {
      const Eigen::Vector3d b = along(++since * piece_s);
      if (models::closest_approach_m(a, b, pieces[k].from_m, pieces[k].to_m) - slack_m -
              pieces[k].slack_m <
          required_m_[i]) {
        return false;
      }
      a = b;
    }
  }
  return true;
}

bool arc_is_clear(const models::World& world, const Pose2& from,
                  const models::UnicycleControl& control, double duration_s, double radius_m) {
  constexpr double kResolution_m = 1e-6;
  // Parts of the arc not yet checked, as a stack of bisections: start and length in seconds.
  struct Part {
    double start_s;
    double length_s;
  };
  Part stack[64];
  int depth = 0;
  stack[depth++] = {0.0, duration_s};
  const double speed_mps = std::abs(control.speed_mps);
  const double whole_half_m = 0.5 * speed_mps * duration_s;
  const models::NearbyObstacles nearby = models::nearby_obstacles(
      world, models::step_unicycle(from, control, 0.5 * duration_s).position_m(),
      radius_m + 2.0 * whole_half_m + kResolution_m);
  while (depth > 0) {
    const Part part = stack[--depth];
    const double middle_s = part.start_s + 0.5 * part.length_s;
    const double half_m = 0.5 * speed_mps * part.length_s;
    const Pose2 middle = models::step_unicycle(from, control, middle_s);
    const double free_m = models::clearance_m(world, nearby, middle.position_m()) - radius_m;
    if (free_m > half_m) {
      continue;
    }
    if (free_m <= 0.0 || half_m < kResolution_m) {
      return false;
    }
    if (control.yaw_rate_radps == 0.0) {
      // A straight line along a wall may be barely clear over its full length and need thousands of
      // bisections, but its clearance has a closed form. (An arc is near a wall only at one
      // position.)
      const Pose2 end = models::step_unicycle(from, control, duration_s);
      return models::swept_clearance_m(world, from.position_m(), end.position_m()) > radius_m;
    }
    stack[depth++] = {middle_s, 0.5 * part.length_s};
    stack[depth++] = {part.start_s, 0.5 * part.length_s};
  }
  return true;
}

}  // namespace vantage::planner
