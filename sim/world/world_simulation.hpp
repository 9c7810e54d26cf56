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

/// The lab: vehicles in the air, targets that drive about, and who touches whom.
///
/// A robot is either a Quadrotor that follows plans by itself, or a vehicle of the caller's, whose
/// truth counts just so. Robots whose device is real are not here.
///
/// Deterministic: the same scenario, seed, start, plans and commands at the same times give the
/// same bytes. Time is handed in; physics runs in steps that end on each whole multiple of kStep
/// since the epoch. Targets keep away from the caller's vehicles while these are low: people keep
/// the ground free where something starts or lands.
class WorldSimulation {
 public:
  static constexpr Duration kStep{5'000};
  static constexpr double kLowM = 0.9;      ///< a vehicle below it has the ground around it free
  static constexpr double kKeepOutM = 1.0;  ///< between its centre and a target's

  /// @param vehicles  fly instead of the Quadrotors of the same names; they outlive the world
  /// @throws UsageError for a scenario that cannot be simulated, saying which value and why.
  WorldSimulation(const scenario::Scenario& scenario, std::uint64_t seed, Time start,
                  const std::vector<Vehicle*>& vehicles = {});

  /// Steps on to `time` exactly; nothing when that is past.
  void advance_to(Time time);
  [[nodiscard]] Time time() const { return time_; }

  /// Offers a plan to its robot, now; nullopt when that robot is no Quadrotor of this world.
  std::optional<PlanVerdict> offer(const models::RobotPlan& plan);
  /// For one Quadrotor or, with an empty name, all.
  void command(const models::OperatorCommand& command);

  /// All bodies now: robots first, then targets, each in the scenario's order.
  [[nodiscard]] models::TruthFrame truth() const;
  /// A noisy look at all bodies now. Draws random numbers: one call for each instant of capture.
  models::MocapFrame capture() { return camera_.capture(truth()); }
  /// Contacts that began since the last call.
  std::vector<models::ContactReport> take_contacts();

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
  std::vector<Vehicle*> given_;     ///< by the caller
  std::vector<Vehicle*> vehicles_;  ///< both kinds, in the scenario's order
  Ground ground_;
  MocapCamera camera_;
  models::CollisionMonitor collisions_;
  std::vector<Eigen::Vector3d> centres_m_;
  std::vector<models::ContactReport> contacts_;
};

}  // namespace vantage::sim
