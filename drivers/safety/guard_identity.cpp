#include <algorithm>
#include <cmath>

#include "drivers/safety/guard_parts.hpp"

namespace vantage::drivers {

namespace {

/// Relative error of the reported motion at a yaw error of 15°, the limit for arming.
constexpr double kTurnedShare = 0.26;
/// m; a vehicle counts as coming to a stop if it approaches its hover position by steps of this
/// length.
constexpr double kNearer_m = 0.03;
constexpr double kComesToRestMax_s = 4.0;

}  // namespace

// Compares the motion of the body with the vehicle's name with the motion that the autopilot
// reports. Distances are compared, not speeds: frames that jitter by 50 ms shift the body by a few
// centimetres, but change its measured speed by metres per second.
void FlightGuard::Parts::update_identity_inputs(Time now) {
  in.is_pose_distrusted = distrusts_pose;
  const bool has_estimate = is_airborne(ladder.state) && autopilot.has_position &&
                            autopilot.estimator_good &&
                            in.telemetry_age_s <= limits.telemetry_age_hold_s;
  const Eigen::Vector2d seen_m = pose.world_from_body().translation_m.head<2>();
  const Eigen::Vector2d reported_m = dt_s(now) * autopilot.velocity_world_mps.head<2>();
  const double kept = has_estimate ? std::exp(-dt_s(now) / limits.velocity_memory_s) : 0.0;
  moved_apart_m = kept * (moved_apart_m + reported_m - (seen_m - compared_m));
  moved_m = kept * (moved_m + reported_m.norm());
  compared_m = seen_m;
  // Late poses are not compared: they show the vehicle before it braked.
  const bool can_compare = has_estimate && in.pose_age_s <= limits.pose_age_warn_s &&
                           in.pose_latency_s <= limits.pose_latency_hold_s;
  const double apart_m = std::max(0.0, moved_apart_m.norm() - kTurnedShare * moved_m);
  in.velocity_error_mps = can_compare ? apart_m / limits.velocity_memory_s : 0.0;
  // the driver controls the vehicle, not a pilot
  const bool is_ours = autopilot.is_in_our_mode && in.autopilot_obeys;
  const bool hovers = ladder.state == models::FlightState::kHold && is_ours &&
                      course.is_hovering(now) && !is_climbing && !lift.is_under_way();
  const Eigen::Vector3d off_m = pose.predict_m(now, kPredictS) - course.at(now).position_world_m;
  const double off_plane_m = off_m.head<2>().norm();
  const bool is_deviating =
      hovers && can_compare &&
      (in.speed_mps > limits.hover_speed_mps || off_plane_m > limits.hover_off_m ||
       autopilot.velocity_world_mps.head<2>().norm() > limits.hover_speed_mps);
  hover_deviation_s = is_deviating ? hover_deviation_s + dt_s(now) : 0.0;
  farthest_off_m = is_deviating ? std::max(farthest_off_m, off_plane_m) : off_plane_m;
  const bool comes_nearer = off_plane_m < farthest_off_m - kNearer_m;
  farthest_off_m = comes_nearer ? off_plane_m : farthest_off_m;
  in.is_hover_deviating = is_deviating && (!comes_nearer || hover_deviation_s > kComesToRestMax_s);
  const bool comes_down = ladder.state == models::FlightState::kLand && is_sinking && is_ours &&
                          in.telemetry_age_s <= limits.telemetry_age_hold_s &&
                          in.pose_age_s <= limits.pose_age_warn_s &&
                          in.height_m - ground_m.value_or(0.0) > limits.safe_height_m;
  in.sink_error_m = comes_down ? std::max(0.0, in.height_m - height_ref_m) : 0.0;
}

}  // namespace vantage::drivers
