#include "drivers/safety/autopilot_watch.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"

namespace vantage::drivers {

using models::FlightState;

namespace {

constexpr double kFallsMps = 1.0;  // m/s; faster than any landing
constexpr int kDisarmedBeats = 3;
// relative error of the reported motion at a yaw error of 15°, the limit for arming
constexpr double kTurnedShare = 0.26;
// m; a vehicle counts as coming to a stop if it approaches its hover position by steps of this
// length
constexpr double kNearerM = 0.03;
constexpr double kComesToRestMaxS = 4.0;

bool is_sound(const AutopilotReport& report) {
  return std::isfinite(report.tilt_rad) &&
         (!report.has_position ||
          (report.position_world_m.allFinite() && report.velocity_world_mps.allFinite())) &&
         (!report.has_attitude ||
          (report.world_from_body.coeffs().allFinite() && std::isfinite(report.yaw_rate_radps)));
}

}  // namespace

void AutopilotWatch::on_report(const AutopilotReport& report, Time now) {
  if (!is_sound(report)) {
    ++refused_;
    return;
  }
  report_ = report;
  report_at_ = now;
}

void AutopilotWatch::on_heartbeat(Time now) {
  heartbeat_at_ = now;
  disarmed_beats_ = report_.armed ? 0 : std::min(disarmed_beats_ + 1, 1000);
}

void AutopilotWatch::on_battery(double share, Time now) {
  if (!(share >= 0.0 && share <= 1.0)) {
    ++refused_;
    return;
  }
  if (!battery_at_ || share != battery_share_) {
    battery_changed_at_ = now;
  }
  battery_share_ = share;
  battery_at_ = now;
}

bool AutopilotWatch::has_estimate(const GuardCore& core) const {
  return report_.has_position && report_.estimator_good &&
         core.inputs().telemetry_age_s <= core.limits().telemetry_age_hold_s;
}

bool AutopilotWatch::is_assumed_armed(const GuardCore& core, Time now) const {
  if (report_.armed || !core.inputs().autopilot_armed || !is_airborne(core.state())) {
    return report_.armed;
  }
  if (core.pose().age_s(now) <= core.limits().pose_age_hold_s) {
    const bool is_down = core.position_m(now).z() < core.limits().safe_height_m;
    return !is_down && core.pose().velocity_world_mps().z() > -kFallsMps;
  }
  return disarmed_beats_ < kDisarmedBeats;
}

void AutopilotWatch::update_inputs(GuardCore& core, const FlightPhase& phase,
                                   const HeightState& height, Time now) {
  SafetyInputs& in = core.inputs();
  const SafetyLimits& limits = core.limits();
  in.autopilot_obeys = report_.obeys;
  in.is_flown_by_hand = report_.is_flown_by_hand;
  in.estimator_good = report_.estimator_good;
  estimator_good_at_ = in.estimator_good ? now : estimator_good_at_;
  in.tilt_rad = report_.tilt_rad;
  in.motor_failed = report_.motor_failed;
  in.battery_share = battery_share_;
  in.battery_unchanged_s =
      battery_at_ ? std::min(in.flight_s, time_since_s(battery_changed_at_, now)) : 0.0;
  compare_poses(core, now);
  compare_motion(core, now);
  check_hover(core, phase.is_taking_off, now);
  const bool comes_down = phase.is_descending && report_.is_in_our_mode && in.autopilot_obeys &&
                          in.telemetry_age_s <= limits.telemetry_age_hold_s &&
                          in.pose_age_s <= limits.pose_age_warn_s &&
                          in.height_m - height.ground_m.value_or(0.0) > limits.safe_height_m;
  in.sink_error_m = comes_down ? std::max(0.0, in.height_m - height.command_m) : 0.0;
}

void AutopilotWatch::compare_poses(GuardCore& core, Time now) const {
  SafetyInputs& in = core.inputs();
  const Pose3& pose = core.pose().world_from_body();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  in.estimate_error_m = in.attitude_error_rad = in.yaw_error_rad = 0.0;
  in.body_tilt_rad =
      core.pose().has_pose() ? std::acos(std::clamp((pose.rotation * up).z(), -1.0, 1.0)) : 0.0;
  if (!has_estimate(core) || in.pose_age_s > core.limits().pose_age_warn_s) {
    return;
  }
  in.estimate_error_m = (report_.position_world_m - core.position_m(now)).norm();
  if (!report_.has_attitude) {
    in.attitude_error_rad = in.yaw_error_rad = kNever;
    return;
  }
  const Quaternion& estimated = report_.world_from_body;
  const double cosine = (pose.rotation.inverse() * up).dot(estimated.inverse() * up);
  in.attitude_error_rad = std::acos(std::clamp(cosine, -1.0, 1.0));
  in.yaw_error_rad = std::abs(
      wrap_to_pi(flatten(pose).yaw_rad - flatten({Eigen::Vector3d::Zero(), estimated}).yaw_rad));
}

// Late poses are not compared: they show the vehicle before it braked.
bool AutopilotWatch::can_compare_motion(const GuardCore& core) const {
  return is_airborne(core.state()) && has_estimate(core) &&
         core.inputs().pose_age_s <= core.limits().pose_age_warn_s &&
         core.inputs().pose_latency_s <= core.limits().pose_latency_hold_s;
}

// Compares the motion of the body with the vehicle's name with the motion that the autopilot
// reports. Distances are compared, not speeds: frames that jitter by 50 ms shift the body by a few
// centimetres, but change its measured speed by metres per second.
void AutopilotWatch::compare_motion(GuardCore& core, Time now) {
  const double memory_s = core.limits().velocity_memory_s;
  const double dt_s = core.dt_s(now);
  const Eigen::Vector2d seen_m = core.pose().world_from_body().translation_m.head<2>();
  const Eigen::Vector2d reported_m = dt_s * report_.velocity_world_mps.head<2>();
  const bool is_kept = is_airborne(core.state()) && has_estimate(core);
  const double kept = is_kept ? std::exp(-dt_s / memory_s) : 0.0;
  moved_apart_m_ = kept * (moved_apart_m_ + reported_m - (seen_m - compared_m_));
  moved_m_ = kept * (moved_m_ + reported_m.norm());
  compared_m_ = seen_m;
  const double apart_m = std::max(0.0, moved_apart_m_.norm() - kTurnedShare * moved_m_);
  core.inputs().velocity_error_mps = can_compare_motion(core) ? apart_m / memory_s : 0.0;
}

void AutopilotWatch::check_hover(GuardCore& core, bool is_taking_off, Time now) {
  SafetyInputs& in = core.inputs();
  const SafetyLimits& limits = core.limits();
  // the driver controls the vehicle, not a pilot
  const bool is_ours = report_.is_in_our_mode && in.autopilot_obeys;
  const bool hovers = core.state() == FlightState::kHold && is_ours &&
                      core.course().is_hovering(now) && !is_taking_off;
  const Eigen::Vector3d off_m = core.position_m(now) - core.course().at(now).position_world_m;
  const double off_plane_m = off_m.head<2>().norm();
  const bool is_deviating =
      hovers && can_compare_motion(core) &&
      (in.speed_mps > limits.hover_speed_mps || off_plane_m > limits.hover_off_m ||
       report_.velocity_world_mps.head<2>().norm() > limits.hover_speed_mps);
  hover_deviation_s_ = is_deviating ? hover_deviation_s_ + core.dt_s(now) : 0.0;
  farthest_off_m_ = is_deviating ? std::max(farthest_off_m_, off_plane_m) : off_plane_m;
  const bool comes_nearer = off_plane_m < farthest_off_m_ - kNearerM;
  farthest_off_m_ = comes_nearer ? off_plane_m : farthest_off_m_;
  in.is_hover_deviating = is_deviating && (!comes_nearer || hover_deviation_s_ > kComesToRestMaxS);
}

}  // namespace vantage::drivers
