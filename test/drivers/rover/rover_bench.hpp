#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "drivers/rover/driver.hpp"
#include "sim/rover/rover_emulator.hpp"
#include "test/drivers/vehicle/stepped_bench.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::test {

/// A closed loop in virtual time: driver, emulated rover with tyre slip, mocap at 100 Hz with noise
/// and 5 ms of latency, operator and planner. R1 starts at (1, 1) with its heading along y.
class RoverBench : public SteppedBench {
 public:
  static constexpr Duration kStep{5'000};
  static constexpr double kMarkersM = 0.2;  ///< m; height of its markers

  static scenario::Scenario scenario_for() {
    scenario::Scenario scenario = lab_scenario();
    scenario.world.obstacles.clear();
    scenario.targets.resize(1);
    scenario.robots.resize(1);
    scenario.robots[0].name = "R1";
    scenario.robots[0].start = {1.0, 1.0, kPi / 2};
    scenario.robots[0].height_m = kMarkersM;
    scenario.robots[0].limits = {1.0, 2.0, 2.0, 0.2};
    scenario.robots[0].rover = scenario::RoverSpec{"udpout://127.0.0.1:1", 7};
    return scenario;
  }
  static sim::RoverEmulatorSpec rover_spec() {
    sim::RoverEmulatorSpec spec;
    spec.number = 7;
    spec.start = {1.0, 1.0, kPi / 2};
    return spec;
  }

  /// Returns the limits of a rover that may drive by POSE_R.
  static drivers::SafetyLimits estimate_limits(bool moves_by_estimate = true) {
    drivers::SafetyLimits limits = drivers::limits_for(scenario_for(), "R1");
    limits.moves_by_estimate = moves_by_estimate;
    return limits;
  }

  explicit RoverBench(const scenario::Scenario& given = scenario_for(),
                      const sim::RoverEmulatorSpec& spec = rover_spec())
      : RoverBench(given, spec, drivers::limits_for(given, "R1")) {}
  explicit RoverBench(const drivers::SafetyLimits& limits)
      : RoverBench(scenario_for(), rover_spec(), limits) {}
  RoverBench(const scenario::Scenario& given, const sim::RoverEmulatorSpec& spec,
             const drivers::SafetyLimits& limits)
      : scenario(given), driver(scenario, "R1", limits, 41), rover(spec, kStart) {}

  void step() final {
    if (steps % 2 == 0 && mocap_on) {
      if (captured.stamp.time > Time{}) {
        driver.on_mocap(captured, now, pose_sigma_m);  // the frame is 5 ms old
      }
    }
    captured = capture();
    now += kStep;
    rover.advance_to(now);
    if (const auto telemetry = rover.take_output(); telemetry && telemetry_on) {
      driver.receive(*telemetry, now);
    }
    if (steps % 40 == 0 && operator_on) {
      (void)command(models::OperatorAction::kHeartbeat);
    }
    if (steps % 4 == 0 && driver_on) {
      const drivers::RoverMessage sent = driver.tick(now);
      if (commands_on) {
        rover.receive(change ? change(sent) : sent, now);
      }
    }
    ++steps;
  }

  drivers::CommandVerdict command(models::OperatorAction action) {
    return driver.on_command(next_command(action), now);
  }
  /// Sends a plan that begins after `delay_s` at `start`, by default at the current pose.
  drivers::PlanVerdict plan(const std::vector<models::PlanSegment>& segments, double delay_s = 0.3,
                            std::optional<Pose2> start = std::nullopt) {
    return driver.on_plan(
        next_plan("R1", now + from_seconds(delay_s), start.value_or(rover.state().world_from_body),
                  kMarkersM, segments),
        now);
  }
  /// Arms, commands `follow` and runs 1.5 s in total; returns whether the rover obeyed both
  /// commands.
  bool make_ready() {
    run(1.0);
    const bool armed = command(models::OperatorAction::kArm) == drivers::CommandVerdict::kObeyed;
    run(0.1);
    const bool follows =
        command(models::OperatorAction::kFollow) == drivers::CommandVerdict::kObeyed;
    run(0.4);
    return armed && follows;
  }
  /// Returns segments straight ahead at `speed_mps` for `seconds`, then braking.
  static std::vector<models::PlanSegment> straight(double speed_mps, double seconds) {
    return {{{speed_mps, 0.0}, seconds, 0.0}, {{speed_mps, 0.0}, speed_mps / 2.0, 2.0}};
  }

  [[nodiscard]] Eigen::Vector2d place_m() const {
    return rover.state().world_from_body.position_m();
  }
  [[nodiscard]] bool is_stationary() const { return rover.state().speed_mps == 0.0; }
  [[nodiscard]] bool has_reason(const std::string& reason) const {
    const auto reasons = driver.status(now).reasons;
    return std::find(reasons.begin(), reasons.end(), reason) != reasons.end();
  }

  scenario::Scenario scenario;
  drivers::RoverDriver driver;
  sim::RoverEmulator rover;
  std::int64_t steps = 0;
  bool mocap_on = true;
  double pose_sigma_m = 0.0;  ///< m; 1σ of the estimate that replaces mocap; 0: mocap
  bool telemetry_on = true;
  bool commands_on = true;
  bool operator_on = true;
  bool driver_on = true;
  std::optional<Pose3> shown_pose;  ///< if set, pose in mocap frames instead of the true pose
  std::optional<Eigen::Vector2d> target_m;
  std::function<drivers::RoverMessage(const drivers::RoverMessage&)> change;

 private:
  models::MocapFrame capture() {
    std::uniform_real_distribution<double> noise_m(-3e-4, 3e-4);
    models::MocapFrame frame;
    frame.stamp.time = now;
    frame.arrival = now + kStep;
    frame.frame_number = steps;
    models::MocapBody body;
    body.name = "R1";
    body.world_from_body = shown_pose.value_or(lift(rover.state().world_from_body, kMarkersM));
    body.world_from_body.translation_m += Eigen::Vector3d(noise_m(random), noise_m(random), 0.0);
    frame.bodies.push_back(body);
    if (target_m) {
      models::MocapBody other;
      other.name = scenario.targets[0].name;
      other.world_from_body.translation_m = {target_m->x(), target_m->y(), kMarkersM};
      frame.bodies.push_back(other);
    }
    return frame;
  }

  models::MocapFrame captured;
  std::mt19937_64 random{7};
};

}  // namespace vantage::test
