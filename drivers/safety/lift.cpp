#include "drivers/safety/lift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"

namespace vantage::drivers {
namespace {

constexpr double kOnItsWayM = 0.02;  // m; a climbing body counts as lifting above this rise
constexpr double kStillLiftingM = 0.5;
constexpr double kClimbsMps = 0.05;
constexpr double kTurnSlackS = 6.0;     // s; additional time for the start of the motors
constexpr double kReportAgeMaxS = 0.5;  // s; maximum age of a report; vehicles report at 10 Hz
constexpr double kTurnDelayS = 0.15;
constexpr double kShownShare = 0.3;  // required share of a commanded step or turn
// m below the hover height, where the verification starts
constexpr double kProofHeightToleranceM = 0.06;

}  // namespace

LiftQueue::LiftQueue(const scenario::Scenario& scenario, const std::string& own_name) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    own_ = robot.name == own_name ? robots_.size() : own_;
    robots_.push_back({});
    robots_.back().name = robot.name;
  }
  front_ = robots_.size();
}

bool LiftQueue::is_before(const Entry& a, const Entry& b) {
  return a.order != b.order ? a.order < b.order : a.name < b.name;
}

void LiftQueue::on_take_off(const std::string& robot) {
  ++orders_;
  for (Entry& entry : robots_) {
    if ((robot.empty() || entry.name == robot) && !entry.is_ordered) {
      entry.is_ordered = true;
      entry.order = orders_;
    }
  }
}

void LiftQueue::on_lifting(const std::string& robot, Time now) {
  for (Entry& entry : robots_) {
    if (entry.name == robot) {
      entry.has_reported = true;
      entry.reported_at = now;
    }
  }
}

void LiftQueue::forget_own() {
  if (own_ < robots_.size()) {
    robots_[own_].is_ordered = false;
  }
}

void LiftQueue::begin_own() {
  for (Entry& entry : robots_) {
    entry.begun_m = entry.height_m;
  }
}

void LiftQueue::update(std::span<const OtherBody> bodies, const SafetyLimits& limits, Time now) {
  for (const OtherBody& body : bodies) {
    if (body.robot < 0 || body.age_s > limits.pose_age_hold_s) {
      continue;
    }
    Entry& entry = robots_[static_cast<std::size_t>(body.robot)];
    entry.height_m = body.position_world_m.z();
    entry.climb_mps = body.velocity_world_mps.z();
    entry.rest_m = entry.is_seen ? std::min(entry.rest_m, entry.height_m) : entry.height_m;
    entry.begun_m = entry.is_seen ? entry.begun_m : entry.height_m;
    entry.is_seen = true;
  }
  is_blocked_ = false;
  other_risen_m_ = 0.0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    Entry& entry = robots_[i];
    const double risen_m = entry.height_m - entry.rest_m;
    if (i != own_ && entry.has_reported && to_seconds(now - entry.reported_at) < kReportAgeMaxS) {
      is_blocked_ = true;
    }
    if (i == own_ || !entry.is_seen) {
      continue;
    }
    if (risen_m > limits.lift_done_m) {
      entry.is_ordered = false;  // this body's turn is over
    }
    if (entry.climb_mps > kClimbsMps) {
      is_blocked_ = is_blocked_ || (risen_m > kOnItsWayM && risen_m < kStillLiftingM);
      // A body that hovered before this vehicle's lift began belongs to another vehicle.
      if (entry.begun_m - entry.rest_m < limits.lift_risen_m) {
        other_risen_m_ = std::max(other_risen_m_, entry.height_m - entry.begun_m);
      }
    }
  }
  std::size_t front = robots_.size();
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].is_ordered &&
        (front == robots_.size() || is_before(robots_[i], robots_[front]))) {
      front = i;
    }
  }
  front_since_ = front == front_ ? front_since_ : now;
  front_ = front;
  if (front_ != robots_.size() && front_ != own_) {
    const Entry& first = robots_[front_];
    const bool has_risen = first.is_seen && first.height_m - first.rest_m > limits.lift_risen_m;
    const double turn_s =
        limits.lift_wait_s + kTurnSlackS + (has_risen ? limits.lift_proof_s : 0.0);
    if (to_seconds(now - front_since_) > turn_s) {
      robots_[front_].is_ordered = false;
    }
    is_blocked_ = true;
  }
  blocked_last_ = is_blocked_ ? now : blocked_last_;
  is_blocked_ = to_seconds(now - blocked_last_) < kTurnDelayS * static_cast<double>(own_ + 1);
}

void Lift::begin(const Pose3& world_from_body, std::span<const OtherBody> others,
                 const SafetyLimits& limits, Time now) {
  phase_ = Phase::kRising;
  since_ = now;
  rest_m_ = world_from_body.translation_m;
  rest_yaw_rad_ = flatten(world_from_body).yaw_rad;
  height_m_ = std::min(rest_m_.z() + limits.lift_height_m, limits.take_off_height_m);
  // The step goes along both axes, so that a mocap frame mirrored in either axis is detected. Of
  // the four such directions, the one with the largest clearance is chosen.
  double roomiest_m = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& sign : {Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(-1.0, 1.0),
                                      Eigen::Vector2d(-1.0, -1.0), Eigen::Vector2d(1.0, -1.0)}) {
    const Eigen::Vector2d step_m = limits.lift_step_m * sign;
    const Eigen::Vector2d there_m = rest_m_.head<2>() + step_m;
    double room_m = std::min(fence_distance_m(limits.fence, there_m),
                             obstacle_distance_m(limits.fence, there_m));
    for (const OtherBody& body : others) {
      const double apart_m = (there_m - body.position_world_m.head<2>()).norm();
      room_m = std::min(room_m, apart_m - limits.vehicle.radius_m);
    }
    if (room_m > roomiest_m) {
      roomiest_m = room_m;
      step_m_ = {step_m.x(), step_m.y(), 0.0};
    }
  }
}

bool Lift::step(const Eigen::Vector3d& position_m, double yaw_rad, Course& course,
                const SafetyLimits& limits, Time now) {
  if (phase_ == Phase::kRising && position_m.z() > height_m_ - kProofHeightToleranceM) {
    phase_ = Phase::kProving;
    since_ = now;
    proof_from_m_ = position_m;
    proof_from_yaw_rad_ = yaw_rad;
    course.hover(rest_m_ + step_m_, wrap_to_pi(rest_yaw_rad_ + limits.lift_turn_rad), now);
  }
  if (phase_ != Phase::kProving) {
    return false;
  }
  const Eigen::Vector3d gone_m = position_m - proof_from_m_;
  const Eigen::Vector3d commanded_m = rest_m_ + step_m_ - proof_from_m_;
  const double commanded_rad =
      wrap_to_pi(rest_yaw_rad_ + limits.lift_turn_rad - proof_from_yaw_rad_);
  const auto is_shown = [](double shown, double commanded) {
    return shown * commanded > 0.0 && std::abs(shown) > kShownShare * std::abs(commanded);
  };
  const bool is_proven = is_shown(gone_m.x(), commanded_m.x()) &&
                         is_shown(gone_m.y(), commanded_m.y()) &&
                         is_shown(wrap_to_pi(yaw_rad - proof_from_yaw_rad_), commanded_rad);
  if (is_proven) {
    phase_ = Phase::kNone;
    course.hover(rest_m_, rest_yaw_rad_, now);
  }
  return is_proven;
}

double Lift::no_rise_s(const Eigen::Vector3d& position_m, const SafetyLimits& limits,
                       Time now) const {
  const bool waits = phase_ == Phase::kRising && position_m.z() - rest_m_.z() < limits.lift_risen_m;
  return waits ? to_seconds(now - since_) : 0.0;
}

double Lift::proof_pending_s(Time now) const {
  return phase_ == Phase::kProving ? to_seconds(now - since_) : 0.0;
}

double Lift::deviation_m(const Eigen::Vector3d& position_m) const {
  if (!is_under_way()) {
    return 0.0;
  }
  const Eigen::Vector2d step_m = step_m_.head<2>();
  const Eigen::Vector2d gone_m = (position_m - rest_m_).head<2>();
  const double share = std::clamp(gone_m.dot(step_m) / step_m.squaredNorm(), 0.0, 1.0);
  return (gone_m - share * step_m).norm();
}

}  // namespace vantage::drivers
