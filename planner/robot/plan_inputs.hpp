#pragma once

#include <map>
#include <optional>
#include <string>

#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "planner/robot/round.hpp"

namespace vantage::planner {

/// All inputs of one robot's plan of one round. An absent input was not received.
struct PlanInputs {
  RoundSchedule::Slot slot;
  std::optional<models::RobotBelief> belief;     ///< belief of this robot
  std::optional<models::BeliefMixture> mixture;  ///< mixture of this robot, same step as `belief`
  std::optional<models::RobotMap> map;           ///< map of this robot, in a mapping scenario
  std::optional<models::MocapFrame> mocap;       ///< poses of all bodies; see `poses`
  /// Newest POSE_R of robots that motion capture does not see; `mocap` contains these poses.
  std::map<std::string, models::PoseEstimate> poses;
  /// An earlier frame; with `mocap` it gives the velocity of bodies other than robots. It is set
  /// only if such a body is in the way. Without an earlier frame, bodies are ignored.
  std::optional<models::MocapFrame> mocap_before;
  std::optional<models::RobotPlan> own_plan;            ///< last published plan of this robot
  std::map<std::string, models::RobotPlan> team_plans;  ///< newest plan of each teammate
  std::map<std::string, models::VehicleStatus> team_statuses;  ///< newest status of each robot
  std::map<std::string, models::PlanProposal> proposals;       ///< newest proposal of each robot
  std::optional<models::TeamProposal> solution;  ///< best known solution of the local search
  std::optional<models::AttackNotice> attack;
  std::optional<models::RobotPlan> answer;  ///< answer of the external planning process
};

}  // namespace vantage::planner
