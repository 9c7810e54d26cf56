#pragma once

#include <optional>
#include <utility>

#include "vantage_lcm/attack_t.hpp"
#include "vantage_lcm/belief_t.hpp"
#include "vantage_lcm/collision_t.hpp"
#include "vantage_lcm/command_t.hpp"
#include "vantage_lcm/health_t.hpp"
#include "vantage_lcm/host_t.hpp"
#include "vantage_lcm/map_t.hpp"
#include "vantage_lcm/measurement_t.hpp"
#include "vantage_lcm/mixture_t.hpp"
#include "vantage_lcm/mocap_frame_t.hpp"
#include "vantage_lcm/plan_t.hpp"
#include "vantage_lcm/proposal_t.hpp"
#include "vantage_lcm/scan_t.hpp"
#include "vantage_lcm/scenario_t.hpp"
#include "vantage_lcm/team_proposal_t.hpp"
#include "vantage_lcm/truth_t.hpp"
#include "vantage_lcm/vehicle_t.hpp"

#include "models/exchange/messages.hpp"

// Conversions between wire structs and models. Nodes only use the models.
//
// from_wire() checks the values: finite numbers, ranges, sizes, symmetric positive definite
// matrices, unit quaternions, known enumerators. It returns nullopt for a message with impossible
// values; to_wire() cannot fail. Every pair has a round-trip test and a refusal test.

namespace vantage::bus {

vantage_lcm::mocap_frame_t to_wire(const models::MocapFrame& frame);
std::optional<models::MocapFrame> from_wire(const vantage_lcm::mocap_frame_t& wire);

vantage_lcm::measurement_t to_wire(const models::RobotMeasurement& detections);
std::optional<models::RobotMeasurement> from_wire(const vantage_lcm::measurement_t& wire);

vantage_lcm::belief_t to_wire(const models::RobotBelief& belief);
std::optional<models::RobotBelief> from_wire(const vantage_lcm::belief_t& wire);

vantage_lcm::mixture_t to_wire(const models::BeliefMixture& mixture);
std::optional<models::BeliefMixture> from_wire(const vantage_lcm::mixture_t& wire);

vantage_lcm::scan_t to_wire(const models::RangeScan& scan);
std::optional<models::RangeScan> from_wire(const vantage_lcm::scan_t& wire);

vantage_lcm::map_t to_wire(const models::RobotMap& map);
std::optional<models::RobotMap> from_wire(const vantage_lcm::map_t& wire);

vantage_lcm::plan_t to_wire(const models::RobotPlan& plan);
std::optional<models::RobotPlan> from_wire(const vantage_lcm::plan_t& wire);

vantage_lcm::proposal_t to_wire(const models::PlanProposal& proposal);
std::optional<models::PlanProposal> from_wire(const vantage_lcm::proposal_t& wire);

vantage_lcm::team_proposal_t to_wire(const models::TeamProposal& proposal);
std::optional<models::TeamProposal> from_wire(const vantage_lcm::team_proposal_t& wire);

vantage_lcm::vehicle_t to_wire(const models::VehicleStatus& status);
std::optional<models::VehicleStatus> from_wire(const vantage_lcm::vehicle_t& wire);

vantage_lcm::command_t to_wire(const models::OperatorCommand& command);
std::optional<models::OperatorCommand> from_wire(const vantage_lcm::command_t& wire);

vantage_lcm::truth_t to_wire(const models::TruthFrame& truth);
std::optional<models::TruthFrame> from_wire(const vantage_lcm::truth_t& wire);

vantage_lcm::collision_t to_wire(const models::CollisionReport& contact);
std::optional<models::CollisionReport> from_wire(const vantage_lcm::collision_t& wire);

vantage_lcm::attack_t to_wire(const models::AttackNotice& attack);
std::optional<models::AttackNotice> from_wire(const vantage_lcm::attack_t& wire);

vantage_lcm::health_t to_wire(const models::ProcessHealth& health);
std::optional<models::ProcessHealth> from_wire(const vantage_lcm::health_t& wire);

vantage_lcm::host_t to_wire(const models::HostReport& report);
std::optional<models::HostReport> from_wire(const vantage_lcm::host_t& wire);

vantage_lcm::scenario_t to_wire(const models::ScenarioNotice& notice);
std::optional<models::ScenarioNotice> from_wire(const vantage_lcm::scenario_t& wire);

/// The wire type that carries `Message`.
template <class Message>
using WireOf = decltype(to_wire(std::declval<const Message&>()));

}  // namespace vantage::bus
