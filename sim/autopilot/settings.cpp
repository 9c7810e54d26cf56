#include "sim/autopilot/settings.hpp"

#include <cmath>

namespace vantage::sim {
namespace {

constexpr double kRadPerDeg = M_PI / 180.0;

/// Returns `seconds`; nullopt (never) if the value is zero or less.
std::optional<double> if_positive(double seconds) {
  return seconds > 0.0 ? std::optional(seconds) : std::nullopt;
}

AutopilotSettings px4(const ParameterValue& value) {
  const auto of = [&](const char* name, double otherwise) {
    return value(name).value_or(otherwise);
  };
  constexpr long kLand = 4;      // value of COM_OBL_RC_ACT: land
  constexpr long kLinkLand = 3;  // value of NAV_DLL_ACT: land
  AutopilotSettings out;
  out.setpoint_loss_s = of("COM_OF_LOSS_T", 1.0);
  out.lands_on_setpoint_loss = std::lround(of("COM_OBL_RC_ACT", 0.0)) == kLand;
  if (std::lround(of("NAV_DLL_ACT", 0.0)) == kLinkLand) {
    out.heartbeat_loss_s = of("COM_DL_LOSS_T", 10.0);
  }
  constexpr double kBeforeNoAidS = 0.4;  // s; PX4 reports the loss this much earlier
  out.pose_loss_s = 1e-6 * of("EKF2_NOAID_TOUT", 5e6) - kBeforeNoAidS;
  out.has_barometer = of("EKF2_BARO_CTRL", 1.0) > 0.0;
  if (const auto idle_s = if_positive(of("COM_DISARM_PRFLT", 10.0))) {
    constexpr double kSpoolUpS = 1.0;  // s; PX4's disarm timer starts at the end of spool-up
    out.idle_disarm_s = *idle_s + kSpoolUpS;
  }
  out.land_disarm_s = if_positive(of("COM_DISARM_LAND", 2.0));
  out.speed_max_mps = of("MPC_XY_VEL_MAX", 12.0);
  out.land_speed_mps = of("MPC_LAND_SPEED", 0.7);
  out.position_gain_per_s = of("MPC_XY_P", 0.95);
  out.yaw_rate_max_radps = kRadPerDeg * of("MC_YAWRATE_MAX", 200.0);
  out.velocity_gain_per_s = of("MPC_XY_VEL_P_ACC", 1.8);
  return out;
}

AutopilotSettings ardupilot(const ParameterValue& value) {
  const auto of = [&](const char* name, double otherwise) {
    return value(name).value_or(otherwise);
  };
  constexpr long kLand = 5;  // value of FS_GCS_ENABLE: land
  constexpr double kLandedS = 0.45;
  AutopilotSettings out;
  out.setpoint_loss_s = of("GUID_TIMEOUT", 3.0);
  if (std::lround(of("FS_GCS_ENABLE", 0.0)) == kLand) {
    out.heartbeat_loss_s = of("FS_GCS_TIMEOUT", 5.0);
  }
  out.station_id = static_cast<int>(std::lround(of("SYSID_MYGCS", 255.0)));
  out.pose_loss_s = 7.0;
  out.lands_on_pose_loss = std::lround(of("FS_EKF_ACTION", 1.0)) != 2;  // 2: holds the altitude
  out.idle_disarm_s = if_positive(of("DISARM_DELAY", 10.0));
  out.land_disarm_s = kLandedS;
  out.speed_max_mps = 0.01 * of("WPNAV_SPEED", 500.0);
  out.yaw_rate_max_radps = 0.01 * kRadPerDeg * of("ATC_SLEW_YAW", 6000.0);
  out.land_speed_mps = 0.01 * of("LAND_SPEED", 50.0);
  return out;
}

}  // namespace

AutopilotSettings settings_of(models::AutopilotDialect dialect, const ParameterValue& value) {
  return dialect == models::AutopilotDialect::kPx4 ? px4(value) : ardupilot(value);
}

}  // namespace vantage::sim
