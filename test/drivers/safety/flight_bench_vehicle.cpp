// Simulated autopilot and airframe of the bench, and the detection of forbidden events.

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

using models::FlightState;

namespace {

constexpr double kSpeedMaxMps = 1.3;
constexpr double kResponseS = 0.1;  // s; equals SafetyLimits::setpoint_lead_s
constexpr double kLagS = 0.15;
constexpr double kAccelerationMaxMps2 = 6.0;
constexpr double kGravityMps2 = 9.81;
constexpr double kEstimatorBlindS = 5.0;  // s; time without poses until the estimate is bad
constexpr double kDriftMps = 0.05;        // m/s; drift of the estimate without poses
constexpr double kSpoolUpS = 0.8;
constexpr double kYawGainPerS = 10.0;
constexpr double kTurnMaxRadps = 4.0;
constexpr double kVelocityMemoryS = 0.2;  // s; time constant of the velocity estimate

double yaw_of(const Pose3& pose) { return flatten(pose).yaw_rad; }

Eigen::Vector3d turned(const Eigen::Vector3d& v, double by_rad) {
  return Eigen::AngleAxisd(by_rad, Eigen::Vector3d::UnitZ()) * v;
}

}  // namespace

// Simulates the estimator and telemetry of the autopilot. Position and yaw come from the poses that
// its driver sends, accelerations and turn rates from its own sensors.
void FlightBench::autopilot(Vehicle& vehicle) {
  Vehicle& driver = connected_driver(vehicle);
  const VehicleKnobs& knobs = driver.knobs;
  vehicle.battery_share -= vehicle.is_armed ? kTickS / 1200.0 : 0.0;
  const bool has_pose = driver.guard->inputs().pose_age_s < 0.05;
  vehicle.without_pose_s = has_pose ? 0.0 : vehicle.without_pose_s + kTickS;
  vehicle.drift_m += has_pose ? Eigen::Vector3d(-0.05 * vehicle.drift_m)
                              : Eigen::Vector3d(kDriftMps * kTickS, 0.0, 0.0);
  if (knobs.is_stalled || knobs.link_cut) {
    return;
  }
  if (ticks_ % 100 == 50) {
    driver.guard->on_heartbeat(now());
  }
  if (!knobs.battery_silent && ticks_ % 50 == 0) {
    const double share =
        knobs.battery_share.value_or(std::round(vehicle.battery_share * 10000.0) / 10000.0);
    driver.guard->on_battery(knobs.battery_frozen ? 0.85 : share, now());
  }
  if (!knobs.telemetry_cut && ticks_ % 2 == 0) {
    const Pose3 fed = shown_pose(shown_vehicle(driver));
    const double yaw_rad = wiring_.has_compass ? vehicle.yaw_rad : yaw_of(fed);
    drivers::AutopilotReport report;
    report.armed = vehicle.is_armed && !knobs.reports_disarmed;
    report.obeys = !knobs.mode_left;
    report.is_in_our_mode = !knobs.mode_left;
    report.estimator_good = !knobs.estimator_bad && vehicle.without_pose_s < kEstimatorBlindS;
    report.motor_failed = knobs.motor_failed;
    report.tilt_rad = knobs.tilt_rad;
    report.has_position = true;
    report.position_world_m = fed.translation_m + vehicle.drift_m;
    report.position_world_m.x() += knobs.estimate_offset_m;
    report.velocity_world_mps = vehicle.estimated_mps;
    report.velocity_world_mps.x() += knobs.velocity_offset_mps;
    report.has_attitude = true;
    report.world_from_body =
        Eigen::AngleAxisd(yaw_rad + knobs.yaw_offset_rad, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(knobs.attitude_offset_rad, Eigen::Vector3d::UnitX());
    report.yaw_rate_radps = vehicle.turn_radps;
    driver.guard->on_autopilot(report, now());
  }
}

void FlightBench::fly(Vehicle& vehicle) {
  using Kind = drivers::FlightSetpoint::Kind;
  Vehicle& driver = connected_driver(vehicle);
  const VehicleKnobs& knobs = driver.knobs;
  const bool receives = !knobs.is_stalled && !knobs.link_cut;
  if (receives) {
    vehicle.setpoint = driver.out.setpoint;
    vehicle.without_setpoint_s = 0.0;
    const bool on_ground = vehicle.position_m.z() <= 0.02;
    if (driver.out.wants_armed && !vehicle.is_armed) {
      vehicle.is_armed = true;
    } else if (!driver.out.wants_armed &&
               (on_ground || vehicle.setpoint.kind == Kind::kMotorsOff)) {
      vehicle.is_armed = false;
    }
  } else {
    vehicle.without_setpoint_s += kTickS;
  }
  vehicle.is_armed = vehicle.is_armed && !knobs.motors_off;
  const Pose3 fed = shown_pose(shown_vehicle(driver));
  const Eigen::Vector3d fed_mps = wiring_.mocap_from_world * shown_vehicle(driver).velocity_mps;
  const double yaw_rad = wiring_.has_compass ? vehicle.yaw_rad : yaw_of(fed);
  Eigen::Vector3d ask_mps = Eigen::Vector3d::Zero();
  const bool lands_itself =
      vehicle.without_setpoint_s > 1.0 || vehicle.setpoint.kind == Kind::kBlindLand;
  vehicle.turn_radps = 0.0;
  const bool is_tracking = vehicle.is_armed && vehicle.setpoint.kind == Kind::kTrack;
  vehicle.spool_s = is_tracking ? vehicle.spool_s + kTickS : vehicle.is_armed ? vehicle.spool_s : 0;
  if (vehicle.is_armed && lands_itself) {
    ask_mps = {0.0, 0.0, -0.5};
  } else if (is_tracking && vehicle.spool_s > kSpoolUpS && !knobs.cannot_lift) {
    // A set-point is the desired position after the response time.
    const Eigen::Vector3d believed_m =
        fed.translation_m + vehicle.drift_m + kResponseS * vehicle.velocity_mps;
    ask_mps = vehicle.setpoint.velocity_world_mps +
              2.0 * (vehicle.setpoint.position_world_m - believed_m);
    ask_mps *= std::min(1.0, kSpeedMaxMps / std::max(1e-9, ask_mps.norm()));
    const double turn_rad = wrap_to_pi(vehicle.setpoint.yaw_rad - yaw_rad);
    vehicle.turn_radps = std::clamp(kYawGainPerS * turn_rad, -kTurnMaxRadps, kTurnMaxRadps);
    vehicle.yaw_rad = wrap_to_pi(vehicle.yaw_rad + vehicle.turn_radps * kTickS);
  }
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();
  const bool is_idling = !is_tracking && !lands_itself && vehicle.position_m.z() <= 0.0;
  if (vehicle.is_armed && !is_idling) {
    acceleration_mps2 =
        turned((ask_mps - vehicle.estimated_mps) / kLagS, vehicle.yaw_rad - yaw_rad) +
        knobs.runaway_mps / kLagS;
    acceleration_mps2 *=
        std::min(1.0, kAccelerationMaxMps2 / std::max(1e-9, acceleration_mps2.norm()));
    acceleration_mps2 += knobs.push_mps2;
  } else if (vehicle.position_m.z() > 0.0) {
    acceleration_mps2.z() = -kGravityMps2;
  }
  const Eigen::Vector3d before_mps = vehicle.velocity_mps;
  vehicle.velocity_mps += acceleration_mps2 * kTickS;
  if (vehicle.position_m.z() <= 0.0 && vehicle.velocity_mps.z() <= 0.0) {
    vehicle.velocity_mps.setZero();  // on the floor
    vehicle.ground_s += kTickS;
    const bool comes_down = lands_itself || driver.out.state == FlightState::kLand;
    if (comes_down && vehicle.ground_s > 1.0) {
      vehicle.is_armed = false;
    }
  } else {
    vehicle.ground_s = 0.0;
  }
  vehicle.estimated_mps += turned(vehicle.velocity_mps - before_mps, yaw_rad - vehicle.yaw_rad) +
                           (fed_mps - vehicle.estimated_mps) * (kTickS / kVelocityMemoryS);
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
