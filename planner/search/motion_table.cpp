#include "planner/search/motion_table.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::planner {
namespace {

// Height of a circular arc over its chord, for an arc of `length_m` turning by `angle_rad`.
double sagitta_of(double length_m, double angle_rad) {
  return 0.125 * length_m * std::abs(angle_rad);  // an upper bound: r(1 − cos(a/2)) ≤ r a²/8
}

// Two unicycles cannot be farther from a straight piece than a sagitta, but the speed along it is
// taken as uniform too; for a chord of an arc the deviation in time is of higher order.
constexpr double kChordSlack = 1.1;

}  // namespace

MotionTable::MotionTable(int controls_max, int horizon_max, int teammates_max) {
  primitives_.reserve(static_cast<std::size_t>(controls_max));
  teammate_pieces_.reserve(static_cast<std::size_t>(3 * horizon_max * teammates_max * kPieces));
}

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
    p.length_m = std::abs(control.speed_mps) * problem.step_s;
    p.sagitta_m = kChordSlack * sagitta_of(p.length_m / kPieces, control.yaw_rate_radps * piece_s);
    reach_m_ = std::max(reach_m_, p.length_m);
    primitives_.push_back(p);
  }

  teammate_pieces_.clear();
  int steps = problem.horizon_steps + 1;
  for (const models::Trajectory& teammate : problem.teammates) {
    const double left_s = to_seconds(models::end_time(teammate) - problem.start_time);
    steps = std::max(steps, static_cast<int>(std::ceil(left_s / problem.step_s)) + 1);
  }
  if (problem.brake_mps2 > 0.0) {  // our own last stop may outlast theirs
    steps += static_cast<int>(
        std::ceil(reach_m_ / problem.step_s / problem.brake_mps2 / problem.step_s));
  }
  pieces_each_ = steps * kPieces;
  for (const models::Trajectory& teammate : problem.teammates) {
    for (int depth = 0; depth < steps; ++depth) {
      for (int k = 0; k < kPieces; ++k) {
        const double from_s = depth * problem.step_s + k * piece_s;
        const auto a = models::at(teammate, problem.start_time + from_seconds(from_s));
        const auto b = models::at(teammate, problem.start_time + from_seconds(from_s + piece_s));
        TeammatePiece piece;
        piece.from_m << a.world_from_body.position_m(), teammate.height_m;
        piece.to_m << b.world_from_body.position_m(), teammate.height_m;
        // A piece may straddle two segments of the teammate's: bound by what speed allows.
        const double travelled_m = std::max(a.control.speed_mps, b.control.speed_mps) * piece_s;
        const double turned_rad =
            std::abs(wrap_to_pi(b.world_from_body.yaw_rad - a.world_from_body.yaw_rad));
        piece.slack_m = kChordSlack * sagitta_of(travelled_m, turned_rad) +
                        0.25 * std::abs(a.control.speed_mps - b.control.speed_mps) * piece_s;
        teammate_pieces_.push_back(piece);
      }
    }
  }
}

bool MotionTable::is_open_space(const Eigen::Vector2d& p_m) const {
  return problem_->world == nullptr ||
         (problem_->field != nullptr &&
          problem_->field->lower_bound_m(p_m) > problem_->clearance_m + reach_m_);
}

bool MotionTable::is_free(const Pose2& from, double cos_yaw, double sin_yaw, int c,
                          int depth) const {
  const Primitive& primitive = primitives_[static_cast<std::size_t>(c)];
  if (!is_open_space(from.position_m()) && !arc_is_clear(*problem_->world, from, primitive.control,
                                                         problem_->step_s, problem_->clearance_m)) {
    return false;
  }
  return problem_->teammates.empty() || is_apart(from, cos_yaw, sin_yaw, primitive, depth);
}

bool MotionTable::is_apart(const Pose2& from, double cos_yaw, double sin_yaw,
                           const Primitive& primitive, int depth) const {
  const Eigen::Vector3d start(from.x_m, from.y_m, problem_->height_m);
  for (std::size_t i = 0; i < problem_->teammates.size(); ++i) {
    const TeammatePiece* pieces = &teammate_pieces_[i * static_cast<std::size_t>(pieces_each_) +
                                                    static_cast<std::size_t>(depth * kPieces)];
    const double way_m = (pieces[kPieces - 1].to_m - pieces[0].from_m).norm();
    // Far enough apart that one step cannot bring them together: both move at most this far.
    const double far_m = problem_->separation_m + primitive.length_m + 2.0 * way_m + 1.0;
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
      if (nearest_m < problem_->separation_m) {
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
  // The stop, then the hover, against all that the teammates still do: their tables go on until
  // every one of them hovers too.
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
    const TeammatePiece* pieces = &teammate_pieces_[i * static_cast<std::size_t>(pieces_each_)];
    Eigen::Vector3d a = along(0.0);
    int since = 0;
    for (int k = depth * kPieces; k < pieces_each_; ++k) {
      const Eigen::Vector3d b = along(++since * piece_s);
      if (models::closest_approach_m(a, b, pieces[k].from_m, pieces[k].to_m) - slack_m -
              pieces[k].slack_m <
          problem_->separation_m) {
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
  // Parts still to be proven, as an explicit stack of halvings: start and length in seconds.
  struct Part {
    double start_s;
    double length_s;
  };
  Part stack[64];
  int depth = 0;
  stack[depth++] = {0.0, duration_s};
  const double speed_mps = std::abs(control.speed_mps);
  while (depth > 0) {
    const Part part = stack[--depth];
    const double middle_s = part.start_s + 0.5 * part.length_s;
    const double half_m = 0.5 * speed_mps * part.length_s;
    const Pose2 middle = models::step_unicycle(from, control, middle_s);
    const double free_m = models::clearance_m(world, middle.position_m()) - radius_m;
    if (free_m > half_m) {
      continue;
    }
    if (free_m <= 0.0 || half_m < kResolution_m) {
      return false;
    }
    stack[depth++] = {middle_s, 0.5 * part.length_s};
    stack[depth++] = {part.start_s, 0.5 * part.length_s};
  }
  return true;
}

}  // namespace vantage::planner
