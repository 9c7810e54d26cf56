#include "sim/autopilot/profile.hpp"

namespace vantage::sim {
namespace {

AutopilotProfile px4() {
  AutopilotProfile out;
  out.autopilot_id = 12;
  out.follow_mode = 6U << 16U;
  out.land_mode = 4U << 16U | 6U << 24U;
  out.start_mode = 4U << 16U | 3U << 24U;
  out.speaks_to_stations_alone = true;
  out.flags_ground = 0x1EF;
  out.flags_air = 0x06F;
  out.flags_lost = 0x065;
  out.wants_proof_of_life = true;
  out.lands_on_setpoint_loss = true;
  out.feed_forward = 1.0;
  return out;
}

AutopilotProfile ardupilot() {
  AutopilotProfile out;
  out.autopilot_id = 3;
  out.follow_mode = 4;
  out.land_mode = 9;
  out.start_mode = 0;
  out.converge_s = 4.0;
  out.pose_loss_s = 8.0;
  out.flags_ground = 0x33F;
  out.flags_air = 0x33F;
  out.flags_lost = 0x025;
  out.needs_origin = true;
  out.arm_delay_s = 23.0;
  out.refusal = 4;
  out.setpoint_loss_s = 3.0;
  out.takes_off_by_command = true;
  out.carries_targets_on = true;
  out.keeps_braking_on_change = true;
  out.velocity_shaping_s = 0.35;
  out.velocity_gain_per_s = 3.0;
  out.climb_gain_per_s = 3.0;
  out.velocity_integral_per_s2 = 1.0;
  out.feed_forward = 1.0;
  out.position_gain_per_s = 1.0;
  out.spool_up_s = 1.0;
  out.land_speed_mps = 0.5;
  return out;
}

}  // namespace

const AutopilotProfile& profile_of(models::AutopilotDialect dialect) {
  static const AutopilotProfile kPx4 = px4();
  static const AutopilotProfile kArdupilot = ardupilot();
  return dialect == models::AutopilotDialect::kPx4 ? kPx4 : kArdupilot;
}

}  // namespace vantage::sim
