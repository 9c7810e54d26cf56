#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/scenario/scenario.hpp"
#include "sim/collision/collision_monitor.hpp"
#include "sim/quadrotor/quadrotor.hpp"
#include "sim/world/ground.hpp"
#include "sim/world/mocap.hpp"

namespace vantage::sim {

/// The lab: quadrotors that follow plans, targets that drive about, and who touches whom.
///
/// Deterministic: the same scenario, seed, start, plans and commands at the same times give the
/// same bytes. Time is handed in; physics runs in steps that end on each whole multiple of kStep
/// since the epoch. Robots whose device is real are not here.
class WorldSimulation {
 public:
  static constexpr Duration kStep{5'000};

  /// @throws UsageError for a scenario that cannot be simulated, saying which value and why.
  WorldSimulation(const models::Scenario& scenario, std::uint64_t seed, Time start);

  /// Steps on to `time` exactly; nothing when that is past.
  void advance_to(Time time);
  [[nodiscard]] Time time() const { return time_; }

  /// Offers a plan to its robot, now; nullopt when that robot is not simulated here.
  std::optional<PlanVerdict> offer(const models::RobotPlan& plan);
  /// For one robot or, with an empty name, all.
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
  [[nodiscard]] const CollisionMonitor& collisions() const { return collisions_; }

 private:
  void step(Time to);
  void watch();

  std::vector<models::TargetSpec> targets_;
  Time time_;
  Time decided_;
  std::vector<Quadrotor> quadrotors_;
  Ground ground_;
  MocapCamera camera_;
  CollisionMonitor collisions_;
  std::vector<Eigen::Vector3d> centres_m_;
  std::vector<models::ContactReport> contacts_;
};

}  // namespace vantage::sim
