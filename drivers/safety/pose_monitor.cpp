#include "drivers/safety/pose_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.hpp"
#include "drivers/safety/inputs.hpp"
#include "drivers/safety/plan_check.hpp"

namespace vantage::drivers {
namespace {

constexpr double kVelocityMemoryS = 0.05;
constexpr double kUnknownAccelerationMps2 = 10.0;
constexpr double kTurnRadps = 10.0;
constexpr double kUnitTolerance = 0.01;
constexpr double kBelowFloorM = 0.3;

bool is_pose(const Pose3& pose) {
  return pose.translation_m.allFinite() && pose.rotation.coeffs().allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < kUnitTolerance;
}

bool is_in_room(const Eigen::Vector3d& p_m, const SafetyLimits& limits) {
  return fence_distance_m(limits.fence, p_m.head<2>()) > -limits.volume_margin_m &&
         p_m.z() > -kBelowFloorM && p_m.z() < limits.fence.ceiling_m + limits.volume_margin_m;
}

bool is_same(const Pose3& a, const Pose3& b) {
  return a.translation_m == b.translation_m && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

const char* name_of(PoseVerdict verdict) {
  static constexpr std::array<const char*, kPoseVerdicts> kNames = {
      "accepted", "absent", "duplicate", "malformed", "outside",
      "jump",     "flip",   "stuck",     "foreign"};
  return kNames[static_cast<std::size_t>(verdict)];
}

double PoseMonitor::age_s(Time now) const {
  return has_pose_ ? std::max(0.0, to_seconds(now - accepted_at_)) : kNever;
}

Eigen::Vector3d PoseMonitor::predict_m(Time now, double horizon_s) const {
  const double ahead_s = has_pose_ ? std::min(age_s(now), horizon_s) : 0.0;
  return pose_.translation_m + velocity_mps_ * ahead_s;
}

PoseVerdict PoseMonitor::judge(const models::MocapBody* body, const BodyContext& context,
                               const SafetyLimits& limits, Time now) {
  if (body == nullptr || body->occluded) {
    accepted_ = 0;
    return PoseVerdict::kAbsent;
  }
  if (context.is_distrusted) {
    return reject(PoseVerdict::kForeign);
  }
  const Pose3& pose = body->world_from_body;
  if (!is_pose(pose)) {
    return reject(PoseVerdict::kMalformed);
  }
  const bool is_inside = is_in_room(pose.translation_m, limits);
  if (!is_inside && !(has_pose_ && context.in_air)) {
    return reject(PoseVerdict::kOutside);
  }
  if (!has_pose_) {
    begin(pose, now);
    return PoseVerdict::kAccepted;
  }
  if (is_stuck(pose, context, limits, now)) {
    // The pose has been stuck since it first appeared: its age counts from then.
    accepted_at_ = std::min(accepted_at_, identical_since_);
    velocity_mps_.setZero();
    accepted_ = 0;
    return PoseVerdict::kStuck;
  }
  const double gap_s = age_s(now);
  const double gate_m = std::min(
      limits.pose_gate_max_m, limits.pose_gate_m + 0.5 * kUnknownAccelerationMps2 * gap_s * gap_s);
  Eigen::Vector3d off_m = pose.translation_m - predict_m(now, limits.pose_age_land_s);
  off_m.z() = off_m.z() < 0.0 ? std::min(0.0, off_m.z() + context.sunk_m) : off_m.z();
  const bool jumps = off_m.norm() > gate_m;
  const double turn_max_rad =
      limits.pose_flip_rad + std::min(kTurnRadps * gap_s, 0.5 * (kPi - limits.pose_flip_rad));
  const bool flips = pose_.rotation.angularDistance(pose.rotation.normalized()) > turn_max_rad;
  if (jumps || flips) {
    if (context.in_air) {
      return reject(!is_inside ? PoseVerdict::kOutside
                    : jumps    ? PoseVerdict::kJump
                               : PoseVerdict::kFlip);
    }
    begin(pose, now);
    return PoseVerdict::kAccepted;
  }
  update(pose, now);
  return PoseVerdict::kAccepted;
}

void PoseMonitor::begin(const Pose3& pose, Time now) {
  has_pose_ = true;
  pose_ = pose;
  velocity_mps_.setZero();
  turn_radps_ = 0.0;
  accepted_at_ = now;
  identical_since_ = now;
  rejected_ = 0;
  accepted_ = 1;
}

// Sets the position as measured, and the velocity by an α–β filter with time constant
// kVelocityMemoryS. The change of velocity is limited by kUnknownAccelerationMps2: a small jump of
// the pose must not appear as a speed of several metres per second.
void PoseMonitor::update(const Pose3& pose, Time now) {
  const double gap_s = age_s(now);
  if (gap_s > 0.0) {
    const Eigen::Vector3d measured_mps = (pose.translation_m - pose_.translation_m) / gap_s;
    const Eigen::Vector3d change_mps =
        -std::expm1(-gap_s / kVelocityMemoryS) * (measured_mps - velocity_mps_);
    const double turned_rad = wrap_to_pi(flatten(pose).yaw_rad - flatten(pose_).yaw_rad);
    turn_radps_ += -std::expm1(-gap_s / kVelocityMemoryS) * (turned_rad / gap_s - turn_radps_);
    const double change_max_mps = kUnknownAccelerationMps2 * gap_s;
    velocity_mps_ += change_mps * std::min(1.0, change_max_mps / std::max(1e-9, change_mps.norm()));
  }
  if (!is_same(pose, pose_)) {
    identical_since_ = now;
  }
  pose_ = pose;
  accepted_at_ = now;
  rejected_ = 0;
  accepted_ = std::min(accepted_ + 1, 1'000'000);
}

bool PoseMonitor::is_stuck(const Pose3& pose, const BodyContext& context,
                           const SafetyLimits& limits, Time now) {
  // Compares with the last accepted pose: a rejected pose in between does not make a repeated pose
  // new.
  if (!is_same(pose, pose_) || context.may_be_stationary) {
    return false;
  }
  const double allowed_s =
      context.is_moving ? limits.pose_stuck_moving_s : limits.pose_stuck_hover_s;
  return to_seconds(now - identical_since_) > allowed_s;
}

PoseVerdict PoseMonitor::reject(PoseVerdict verdict) {
  rejected_ = std::min(rejected_ + 1, 1'000'000);
  accepted_ = 0;
  return verdict;
}

}  // namespace vantage::drivers
