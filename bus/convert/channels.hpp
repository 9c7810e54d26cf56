#pragma once

#include <chrono>
#include <string>

#include "core/time.hpp"
#include "models/exchange/compact_belief.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"

namespace vantage::bus {

/// Channel name with the only message type that may be sent on it. A name that ends in '*' matches
/// every channel with that prefix; it is for subscribing only.
///
/// LCM cannot distinguish two structs with the same field names and types. Therefore the pairs of
/// name and type are defined only here, and the compiler checks them at every publish() and
/// subscribe().
template <class Message>
struct Channel {
  std::string name;
  bool is_shared = false;  ///< several processes may publish; see SharedStreamMonitor
  /// Time without a message after which another publisher may replace the current one; see
  /// StreamRules.
  Duration lease{};
};

/// Lease of channels with one publisher: receivers accept only the current publisher, so a second
/// mocap or simulation cannot replace the first.
inline constexpr Duration kLease = std::chrono::milliseconds(500);
inline const Channel<models::MocapFrame> kVicon{"VICON", false, kLease};
inline const Channel<models::TruthFrame> kTruth{"TRUTH"};
inline const Channel<models::CollisionReport> kCollision{"COLLISION",
                                                         true};  // publishers: sim, contacts
inline const Channel<models::AttackNotice> kAttack{"ATTACK"};
inline const Channel<models::OperatorCommand> kCommand{"COMMAND", true};  // publisher: any console
inline const Channel<models::ScenarioNotice> kScenario{"SCENARIO"};

/// `robot` "*" subscribes to the channels of all robots.
inline Channel<models::RobotMeasurement> measurement_channel(const std::string& robot) {
  return {"MEASUREMENT_" + robot};
}
inline Channel<models::OdometryReport> odometry_channel(const std::string& robot) {
  return {"ODOMETRY_" + robot};
}
inline Channel<models::SightingReport> sightings_channel(const std::string& robot) {
  return {"SIGHTINGS_" + robot};
}
inline Channel<models::PoseEstimate> pose_channel(const std::string& robot) {
  return {"POSE_" + robot, false, kLease};
}
inline Channel<models::RobotBelief> belief_channel(const std::string& robot) {
  return {"BELIEF_" + robot};
}
inline Channel<models::CompactBelief> compact_belief_channel(const std::string& robot) {
  return {"COMPACT_BELIEF_" + robot};
}
inline Channel<models::BeliefMixture> mixture_channel(const std::string& robot) {
  return {"MIXTURE_" + robot};
}
inline Channel<models::RangeScan> scan_channel(const std::string& robot) {
  return {"SCAN_" + robot};
}
inline Channel<models::RobotMap> map_channel(const std::string& robot) { return {"MAP_" + robot}; }
inline Channel<models::RobotPlan> plan_channel(const std::string& robot) {
  return {"PLAN_" + robot};
}
inline Channel<models::PlanProposal> proposal_channel(const std::string& robot) {
  return {"PROPOSAL_" + robot};
}
inline Channel<models::TeamProposal> team_proposal_channel(const std::string& robot) {
  return {"TEAM_PROPOSAL_" + robot};
}
inline Channel<models::VehicleStatus> vehicle_channel(const std::string& robot) {
  return {"VEHICLE_" + robot, false, kLease};
}
inline Channel<models::ProcessHealth> health_channel(const std::string& process) {
  return {"HEALTH_" + process};
}
inline Channel<models::HostReport> host_channel(const std::string& host) {
  return {"HOST_" + host};
}

/// True if a message is delivered even if it is overtaken, duplicated or has a wrong sequence
/// number. Such messages are commands that make a vehicle safer: receivers check each command,
/// and may safely obey a command twice.
template <class Message>
bool passes_every_filter(const Message& /*message*/) {
  return false;
}
inline bool passes_every_filter(const models::OperatorCommand& command) {
  return makes_safer(command.action);
}

}  // namespace vantage::bus
