#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/contact/collision_monitor.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/quadrotor/quadrotor.hpp"
#include "sim/vehicle.hpp"
#include "sim/world/ground.hpp"
#include "sim/world/mocap.hpp"

namespace vantage::sim {

/// Simulated lab: vehicles, moving targets, and their contacts.
///
/// A robot is either a Quadrotor that follows plans, or a vehicle supplied by the caller, which
/// computes its true state. Robots with a real device are not simulated.
///
/// Deterministic: the same scenario, seed, start, plans and commands at the same times give the
/// same bytes. Time is an argument; physics steps end at each integer multiple of kStep since the
/// epoch. Targets keep away from the caller's vehicles while these are low, as people keep the
/// ground clear where a vehicle starts or lands.
class WorldSimulation {
 public:
  static constexpr Duration kStep{5'000};
  /// m; targets keep away from vehicles below this height
  static constexpr double kLowM = 0.9;
  /// m; distance of the targets' centres from a low vehicle
  static constexpr double kKeepOutM = 1.0;

  /// @param vehicles  vehicles that replace the Quadrotors of the same names; they must outlive the
  /// world
  /// @throws UsageError for a scenario that cannot be simulated, with the value and the rule.
  WorldSimulation(const scenario::Scenario& scenario, std::uint64_t seed, Time start,
                  const std::vector<Vehicle*>& vehicles = {});

  /// Steps to `time` exactly; does nothing if `time` is in the past.
  void advance_to(Time time);
  [[nodiscard]] Time time() const { return time_; }

  /// Offers a plan to its robot now; returns nullopt if that robot is not a Quadrotor of this
  /// world.
  std::optional<PlanVerdict> offer(const models::RobotPlan& plan);
  /// Applies a command to one Quadrotor or, with an empty name, to all Quadrotors.
  void command(const models::OperatorCommand& command);

  /// Sets the error of the pose by which a Quadrotor flies, see Quadrotor::fly_by(). No effect for
  /// other vehicles.
  void fly_by(const std::string& robot, const std::optional<Pose2>& assumed_from_true);

  /// Returns the true state of all bodies now: robots, then targets, each in the scenario's order.
  [[nodiscard]] models::TruthFrame truth() const;
  /// Returns a noisy capture of all bodies now. Draws random numbers: call it once per instant of
  /// capture.
  models::MocapFrame capture() { return camera_.capture(truth()); }
  /// Returns the contacts that began since the last call.
  std::vector<models::CollisionReport> take_contacts();

  [[nodiscard]] const MocapCamera& camera() const { return camera_; }
  [[nodiscard]] const std::vector<Quadrotor>& quadrotors() const { return quadrotors_; }
  [[nodiscard]] const Ground& ground() const { return ground_; }
  [[nodiscard]] const models::CollisionMonitor& collisions() const { return collisions_; }

 private:
  void step(Time to);
  void watch();
  void keep_ground_free();

  std::vector<scenario::TargetSpec> targets_;
  Time time_;
  Time decided_;
  std::vector<Quadrotor> quadrotors_;
  std::vector<Vehicle*> external_vehicles_;  ///< vehicles that the caller simulates
  /// Quadrotors and the caller's vehicles, in the scenario's order of robots
  std::vector<Vehicle*> vehicles_;
  Ground ground_;
  MocapCamera camera_;
  models::CollisionMonitor collisions_;
  std::vector<Eigen::Vector3d> centres_m_;
  std::vector<models::CollisionReport> contacts_;
};

}  // namespace vantage::sim
