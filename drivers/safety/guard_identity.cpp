#include <cmath>

#include "drivers/safety/guard_parts.hpp"

namespace vantage::drivers {

// Compares the body that bears the vehicle's name in flight with what the autopilot feels. A
// vehicle that is steered by the poses of another body does not come to rest.
void FlightGuard::Parts::look_at_identity(Time now) {
  const bool both_known =
      is_airborne(ladder.state) && autopilot.has_position && autopilot.estimator_good &&
      in.telemetry_age_s <= limits.telemetry_age_hold_s && in.pose_age_s <= limits.pose_age_warn_s;
  // The velocity of late poses is late as well.
  const bool can_compare = both_known && in.pose_latency_s <= limits.pose_latency_hold_s;
  if (!is_airborne(ladder.state)) {
    velocity_error_mps.setZero();
  } else if (can_compare) {
    const double share = -std::expm1(-dt_s(now) / limits.velocity_memory_s);
    velocity_error_mps +=
        share * (autopilot.velocity_world_mps - pose.velocity_world_mps() - velocity_error_mps);
  }
  in.velocity_error_mps = can_compare ? velocity_error_mps.head<2>().norm() : 0.0;
  const bool hovers = ladder.state == models::FlightState::kHold && autopilot.is_in_our_mode &&
                      in.autopilot_obeys && course.is_standing(now) && !is_climbing &&
                      !lift.is_under_way();
  const Eigen::Vector3d off_m = pose.predict_m(now, kPredictS) - course.at(now).position_world_m;
  in.is_hold_restless =
      hovers && both_known &&
      (in.speed_mps > limits.hover_speed_mps || off_m.head<2>().norm() > limits.hover_off_m ||
       autopilot.velocity_world_mps.head<2>().norm() > limits.hover_speed_mps);
}

}  // namespace vantage::drivers
