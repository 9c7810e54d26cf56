#include "sim/autopilot/profile.hpp"

namespace vantage::sim {
namespace {

AutopilotProfile px4() {
  AutopilotProfile out;
  out.autopilot_id = 12;
  out.follow_mode = 6U << 16U;
  out.land_mode = 4U << 16U | 6U << 24U;
  out.start_mode = 4U << 16U | 3U << 24U;
  out.texts_need_station = true;
  out.flags_ground = 0x1AF;
  out.flags_air = 0x12F;
  out.flags_stale = 0x02F;
  out.flags_lost = 0x025;
  out.estimator.converge_s = 0.2;
  out.estimator.wander_mps3 = 0.001;
  out.estimator.gate_m = 0.8;
  out.estimator.reset_after_s = 1.1;
  out.estimator.rejected_loss_s = 5.0;
  out.cuts_whole_velocity = true;
  out.arming_text = "Armed by external command\t";
  out.landed_text = "Disarmed by landing\t";
  out.idle_text = "Disarmed by auto preflight disarming\t";
  out.setpoint_check_s = 0.08;
  out.landing_ahead_s = 0.1;
  out.wants_proof_of_life = true;
  out.feed_forward = 1.0;
  return out;
}

AutopilotProfile ardupilot() {
  AutopilotProfile out;
  out.autopilot_id = 3;
  out.follow_mode = 4;
  out.land_mode = 9;
  out.start_mode = 0;
  out.estimator.converge_s = 0.1;
  out.estimator_boot_s = 3.9;
  out.estimator_aligned_s = 5.0;
  out.flags_ground = 0x33F;
  out.flags_air = 0x33F;
  out.flags_stale = 0x33F;
  out.flags_lost = 0x025;
  out.needs_origin = true;
  out.estimator.wander_mps3 = 0.0023;
  out.estimator.gate_m = 0.2;
  out.estimator.reset_after_s = 20.0;
  out.estimator.rejected_loss_s = 10.0;
  out.lost_before_failsafe_s = 0.95;
  out.accelerometer_delay_s = 12.0;
  out.arm_delay_s = 22.5;
  out.refusal = 4;
  out.arming_text = "Arming motors";
  out.landed_text = "Disarming motors";
  out.idle_text = "Disarming motors";
  out.station_check_s = 1.0 / 3.0;
  out.takes_off_by_command = true;
  out.extrapolates_targets = true;
  out.keeps_braking_on_change = true;
  out.velocity_shaping_s = 0.35;
  out.climb_gain_per_s = 3.0;
  out.velocity_integral_per_s2 = 1.0;
  out.feed_forward = 1.0;
  out.yaw_gain_per_s = 4.0;
  out.yaw_lag_s = 0.3;
  out.spool_up_s = 1.0;
  out.landed_delay_s = 1.35;
  out.landing_ahead_s = 0.5;
  out.failsafe_pause_s = 4.0;
  return out;
}

}  // namespace

const AutopilotProfile& profile_of(models::AutopilotDialect dialect) {
  static const AutopilotProfile kPx4 = px4();
  static const AutopilotProfile kArdupilot = ardupilot();
  return dialect == models::AutopilotDialect::kPx4 ? kPx4 : kArdupilot;
}

}  // namespace vantage::sim
