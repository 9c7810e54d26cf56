// The bench's stand-in for an autopilot and its airframe, and what must never happen to it.

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

using models::FlightState;

namespace {

constexpr double kSpeedMaxMps = 1.3;
constexpr double kLeadS = 0.1;  // SafetyLimits::setpoint_lead_s
constexpr double kLagS = 0.15;
constexpr double kAccelerationMaxMps2 = 6.0;
constexpr double kGravityMps2 = 9.81;
constexpr double kEstimatorBlindS = 5.0;  // it calls itself good for so long without a pose
constexpr double kDriftMps = 0.05;        // of its estimate meanwhile

}  // namespace

// What the vehicle's own electronics know and tell.
void FlightBench::autopilot(Vehicle& vehicle) {
  const VehicleKnobs& knobs = vehicle.knobs;
  vehicle.battery_share -= vehicle.is_armed ? kTickS / 1200.0 : 0.0;
  const bool has_pose = vehicle.guard->inputs().pose_age_s < 0.05;
  vehicle.blind_s = has_pose ? 0.0 : vehicle.blind_s + kTickS;
  vehicle.drift_m += has_pose ? Eigen::Vector3d(-0.05 * vehicle.drift_m)
                              : Eigen::Vector3d(kDriftMps * kTickS, 0.0, 0.0);
  if (knobs.is_stalled || knobs.link_cut) {
    return;
  }
  if (ticks_ % 100 == 50) {
    vehicle.guard->on_heartbeat(now());
  }
  if (!knobs.battery_silent && ticks_ % 50 == 0) {
    const double share =
        knobs.battery_share.value_or(std::round(vehicle.battery_share * 10000.0) / 10000.0);
    vehicle.guard->on_battery(knobs.battery_frozen ? 0.85 : share, now());
  }
  if (!knobs.telemetry_cut && ticks_ % 2 == 0) {
    drivers::AutopilotReport report;
    report.armed = vehicle.is_armed;
    report.obeys = !knobs.mode_left;
    report.estimator_good = !knobs.estimator_bad && vehicle.blind_s < kEstimatorBlindS;
    report.motor_failed = knobs.motor_failed;
    report.tilt_rad = knobs.tilt_rad;
    report.thrust_share = knobs.thrust_saturated ? 1.0 : 0.5;
    report.has_position = true;
    report.position_world_m = vehicle.position_m + vehicle.drift_m;
    report.position_world_m.x() += knobs.estimate_offset_m;
    vehicle.guard->on_autopilot(report, now());
  }
}

void FlightBench::fly(Vehicle& vehicle) {
  using Kind = drivers::FlightSetpoint::Kind;
  const VehicleKnobs& knobs = vehicle.knobs;
  const bool hears = !knobs.is_stalled && !knobs.link_cut;
  if (hears) {
    vehicle.asked = vehicle.out.setpoint;
    vehicle.without_setpoint_s = 0.0;
    const bool on_ground = vehicle.position_m.z() <= 0.02;
    if (vehicle.out.wants_armed && !vehicle.is_armed) {
      vehicle.is_armed = true;
    } else if (!vehicle.out.wants_armed && (on_ground || vehicle.asked.kind == Kind::kMotorsOff)) {
      vehicle.is_armed = false;
    }
  } else {
    vehicle.without_setpoint_s += kTickS;
  }
  Eigen::Vector3d ask_mps = Eigen::Vector3d::Zero();
  const bool lands_itself =
      vehicle.without_setpoint_s > 1.0 || vehicle.asked.kind == Kind::kBlindLand;
  if (vehicle.is_armed && lands_itself) {
    ask_mps = {0.0, 0.0, -0.5};
  } else if (vehicle.is_armed && vehicle.asked.kind == Kind::kTrack) {
    // It is told where to be when it will have answered.
    const Eigen::Vector3d believed_m =
        vehicle.position_m + vehicle.drift_m + kLeadS * vehicle.velocity_mps;
    ask_mps =
        vehicle.asked.velocity_world_mps + 2.0 * (vehicle.asked.position_world_m - believed_m);
    ask_mps *= std::min(1.0, kSpeedMaxMps / std::max(1e-9, ask_mps.norm()));
    const double turn_rad = wrap_to_pi(vehicle.asked.yaw_rad - vehicle.yaw_rad);
    vehicle.yaw_rad =
        wrap_to_pi(vehicle.yaw_rad + std::clamp(turn_rad, -4.0 * kTickS, 4.0 * kTickS));
  }
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();
  if (vehicle.is_armed) {
    acceleration_mps2 = (ask_mps + knobs.runaway_mps - vehicle.velocity_mps) / kLagS;
    acceleration_mps2 *=
        std::min(1.0, kAccelerationMaxMps2 / std::max(1e-9, acceleration_mps2.norm()));
    acceleration_mps2 += knobs.push_mps2;
  } else if (vehicle.position_m.z() > 0.0) {
    acceleration_mps2.z() = -kGravityMps2;
  }
  vehicle.velocity_mps += acceleration_mps2 * kTickS;
  if (vehicle.position_m.z() <= 0.0 && vehicle.velocity_mps.z() <= 0.0) {
    vehicle.velocity_mps.setZero();  // the floor
    vehicle.ground_s += kTickS;
    const bool comes_down = lands_itself || vehicle.out.state == FlightState::kLand;
    if (comes_down && vehicle.ground_s > 1.0) {
      vehicle.is_armed = false;
    }
  } else {
    vehicle.ground_s = 0.0;
  }
  vehicle.position_m += vehicle.velocity_mps * kTickS;
  vehicle.position_m.z() = std::max(0.0, vehicle.position_m.z());
  vehicle.has_flown = vehicle.has_flown || vehicle.position_m.z() > 0.5;
}

void FlightBench::check() {
  const auto say_once = [this](const std::string& words) {
    if (std::find(violations_.begin(), violations_.end(), words) == violations_.end()) {
      violations_.push_back(words);
    }
  };
  for (const Vehicle& a : vehicles_) {
    const Eigen::Vector2d p_m = a.position_m.head<2>();
    if (drivers::fence_distance_m(scenario_.world, p_m) < 0.0) {
      say_once(a.name + " left the fence");
    }
    if (drivers::obstacle_distance_m(scenario_.world, p_m) < 0.25) {
      say_once(a.name + " touched the obstacle");
    }
    if (!a.out.setpoint.position_world_m.allFinite() ||
        !a.out.setpoint.velocity_world_mps.allFinite()) {
      say_once(a.name + " was asked for something that is no number");
    }
    for (const Vehicle& b : vehicles_) {
      if (a.name < b.name) {
        const double apart_m = (a.position_m - b.position_m).norm();
        closest_m_ = std::min(closest_m_, apart_m);
        if (apart_m < kSeparationMinM) {
          say_once(a.name + " and " + b.name + " collided");
        }
      }
    }
  }
}

}  // namespace vantage::test
