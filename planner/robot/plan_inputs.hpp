#pragma once

#include <map>
#include <optional>
#include <string>

#include "models/exchange/messages.hpp"
#include "planner/robot/round.hpp"

namespace vantage::planner {

/// Everything that one robot's plan of one round is made from. Absent: not heard (yet).
struct PlanInputs {
  RoundSchedule::Slot slot;
  std::optional<models::RobotBelief> belief;     ///< own
  std::optional<models::BeliefMixture> mixture;  ///< own, of the belief's step
  std::optional<models::RobotMap> map;           ///< own, of a scenario that maps
  std::optional<models::MocapFrame> mocap;       ///< where everybody is
  /// An earlier frame: with `mocap` it gives the velocity of bodies other than robots. Present only
  /// where such a body is in the way; without it such bodies are ignored.
  std::optional<models::MocapFrame> mocap_before;
  std::optional<models::RobotPlan> own_plan;                   ///< last one published
  std::map<std::string, models::RobotPlan> team_plans;         ///< newest of each teammate
  std::map<std::string, models::VehicleStatus> team_statuses;  ///< do all follow their plans?
  std::map<std::string, models::PlanProposal> proposals;       ///< newest of each robot, own too
  std::optional<models::TeamProposal> solution;                ///< best known of a local search
  std::optional<models::AttackNotice> attack;
  std::optional<models::RobotPlan> answer;  ///< of the process that is asked for plans
};

}  // namespace vantage::planner
