#pragma once

#include <map>
#include <optional>
#include <string>

#include "models/exchange/messages.hpp"
#include "planner/robot/round.hpp"

namespace vantage::planner {

/// All inputs of one robot's plan of one round. Absent: not received (yet).
struct PlanInputs {
  RoundSchedule::Slot slot;
  std::optional<models::RobotBelief> belief;     ///< of this robot
  std::optional<models::BeliefMixture> mixture;  ///< of this robot, same step as `belief`
  std::optional<models::RobotMap> map;           ///< of this robot, in a mapping scenario
  std::optional<models::MocapFrame> mocap;       ///< poses of all bodies
  /// An earlier frame; with `mocap` it gives the velocity of bodies other than robots. Set only if
  /// such a body is in the way; without it such bodies are ignored.
  std::optional<models::MocapFrame> mocap_before;
  std::optional<models::RobotPlan> own_plan;                   ///< last published
  std::map<std::string, models::RobotPlan> team_plans;         ///< newest of each teammate
  std::map<std::string, models::VehicleStatus> team_statuses;  ///< newest of each robot
  std::map<std::string, models::PlanProposal> proposals;       ///< newest of each robot
  std::optional<models::TeamProposal> solution;                ///< best known in the local search
  std::optional<models::AttackNotice> attack;
  std::optional<models::RobotPlan> answer;  ///< of the external planning process
};

}  // namespace vantage::planner
