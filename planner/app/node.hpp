#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/neighbour_watch.hpp"
#include "bus/node/node.hpp"
#include "planner/app/node_state.hpp"
#include "planner/app/plan_mode.hpp"
#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Bus node of a RobotPlanner. Inputs: BELIEF_R with its MIXTURE_R (and MAP_R in mapping), VICON,
/// teammates' PLAN_* and ATTACK. Output: PLAN_R, once per round in this robot's slot. Its PlanMode
/// exchanges the other messages of a round.
///
/// With a neighbourhood (network.neighbourhood_m) the node subscribes only to teammates within that
/// distance. If the clock is not real time, the search budget is planner.node_budget nodes.
class PlannerNode : public bus::Node {
 public:
  PlannerNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
              const std::string& robot);
  /// Creates one of several nodes that run in turn in one thread and share a workspace.
  PlannerNode(bus::Bus& bus, const bus::Clock& clock, std::shared_ptr<Workspace> workspace,
              const std::string& robot);

  [[nodiscard]] std::string name() const override { return "PLANNER_" + state_.robot; }
  [[nodiscard]] Time next_tick() const override { return mode_->next_tick(); }
  void tick(Time now) override;
  void on_processor_wait(double wait_s) override { processor_wait_s_ = wait_s; }
  /// Returns the counters of the planner and these: slots_skipped; misaddressed (messages with a
  /// robot name that differs from that of their channel); unusable_plans (plans of teammates that
  /// are too long or too far in the future); proposals_refused (inconsistent proposals in a round
  /// of local search). With an external planner: external_rounds (rounds answered in time),
  /// external_missing (rounds without an answer), external_late (answers after the deadline),
  /// external_unasked (answers without a request, or duplicates), external_refused (answers that
  /// are not valid plans; unsafe plans count as plan_checks_failed). With shared slots:
  /// yielded_rounds. bodies_dropped: bodies in the way that were ignored because a plan can avoid
  /// only a limited number. rounds_short_of_processor: rounds in which a robot with a driver brakes
  /// instead of searching, because its planner gets too little processor time.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  [[nodiscard]] std::int64_t deadlines_missed() const override { return state_.plans_late; }

 private:
  void subscribe_to_own();
  void subscribe_to_status(const std::string& name);
  /// Subscribes to POSE_* of the robots in the section `localizer`, if any.
  void subscribe_to_poses();
  void subscribe_to_teammate(const std::string& name);
  void unsubscribe_from_teammate(const std::string& name);
  void take_frame(const std::shared_ptr<const models::MocapFrame>& frame);
  /// Makes the newest mocap frame an input, and POSE_* of the robots that this frame does not show.
  /// If bodies are in the way, an earlier frame becomes an input too.
  void use_frames();
  void take_plan(const models::RobotPlan& plan);
  /// True if the process waits so long for a processor that a vehicle must not rely on its next
  /// plan.
  [[nodiscard]] bool is_short_of_processor() const;
  void plan(Time now);
  /// Selects the robot's first slot that begins after `after`.
  void move_on(Time after);

  std::shared_ptr<Workspace> workspace_;
  NodeState state_;
  RoundSchedule schedule_;
  std::unique_ptr<PlanMode> mode_;
  Time attack_received_{};
  std::shared_ptr<const models::MocapFrame>
      mocap_;  ///< newest frame; it becomes an input when the slot begins
  /// Earlier frames, at least kVelocityTime apart, for the velocity of bodies.
  std::shared_ptr<const models::MocapFrame> mocap_before_, mocap_between_;
  std::map<std::string, models::PoseEstimate> poses_;  ///< newest POSE_R with motion, by robot
  std::optional<models::BeliefMixture>
      mixture_;  ///< newest mixture; it arrives before the belief to which it belongs
  std::optional<bus::NeighbourWatch> neighbours_;
  std::int64_t slots_skipped_ = 0;
  std::int64_t short_of_processor_ = 0;
  double processor_wait_s_ = 0.0;  ///< time waiting for a processor during the last second
  std::int64_t unusable_plans_ = 0;
};

}  // namespace vantage::planner
