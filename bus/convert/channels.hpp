#pragma once

#include <chrono>
#include <string>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// A channel name welded to the one message that may travel on it. A name that ends in '*' stands
/// for every channel with that prefix, for subscribing only.
///
/// LCM cannot tell apart two structs whose fields have the same names and types, so the pairing is
/// made here, once, and checked by the compiler at every publish() and subscribe().
template <class Message>
struct Channel {
  std::string name;
  bool is_shared = false;  ///< several processes may publish on it at once; see SharedStreamMonitor
  /// While its publisher was heard within this, no other replaces it; see StreamRules.
  Duration lease{};
};

/// A second mocap, or a second simulation, takes nothing from those who hear the first.
inline constexpr Duration kLease = std::chrono::milliseconds(500);
inline const Channel<models::MocapFrame> kVicon{"VICON", false, kLease};
inline const Channel<models::TruthFrame> kTruth{"TRUTH"};
inline const Channel<models::ContactReport> kCollision{"COLLISION", true};  // sim and contacts
inline const Channel<models::AttackNotice> kAttack{"ATTACK"};
inline const Channel<models::OperatorCommand> kCommand{"COMMAND", true};  // any console
inline const Channel<models::ScenarioNotice> kScenario{"SCENARIO"};

/// `robot` "*" subscribes to all of them.
inline Channel<models::DetectionSet> measurement_channel(const std::string& robot) {
  return {"MEASUREMENT_" + robot};
}
inline Channel<models::RobotBelief> belief_channel(const std::string& robot) {
  return {"BELIEF_" + robot};
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
/// As logs of before that name have it: for who reads what a log says. Nothing is published on it,
/// and nothing that flies or commands listens to it.
inline Channel<models::VehicleStatus> old_vehicle_channel(const std::string& robot) {
  return {"QUADROTOR_" + robot, false, kLease};
}
inline Channel<models::ProcessHealth> health_channel(const std::string& process) {
  return {"HEALTH_" + process};
}
inline Channel<models::HostReport> host_channel(const std::string& host) {
  return {"HOST_" + host};
}

/// Whether a message is handed on though it is overtaken, sent twice or numbered wrongly. What
/// makes a vehicle safer is: who hears it judges it by itself, and obeying it twice does no harm.
template <class Message>
bool passes_every_filter(const Message& /*message*/) {
  return false;
}
inline bool passes_every_filter(const models::OperatorCommand& command) {
  return makes_safer(command.action);
}

}  // namespace vantage::bus
