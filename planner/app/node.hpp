#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/neighbour_watch.hpp"
#include "bus/node/node.hpp"
#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Bus node of a RobotPlanner. Inputs: BELIEF_R with its MIXTURE_R (and MAP_R in mapping), VICON,
/// teammates' PLAN_* and ATTACK. Output: PLAN_R, once per round in this robot's slot. If the team
/// expects attacks, it also receives and publishes PROPOSAL_*; with local search, TEAM_PROPOSAL_*.
/// With planner.algorithm `external` it publishes EXTERNAL_REQUEST_R and receives EXTERNAL_PLAN_R.
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

  [[nodiscard]] std::string name() const override { return "PLANNER_" + robot_; }
  [[nodiscard]] Time next_tick() const override {
    return is_request_pending_ ? answer_due_ : std::min(slot_.begin, next_exchange_);
  }
  void tick(Time now) override;
  void on_processor_wait(double wait_s) override { processor_wait_s_ = wait_s; }
  /// Returns the counters of the planner and these: slots_skipped; misaddressed (messages with a
  /// robot name that differs from that of their channel); unusable_plans (plans of teammates that
  /// are too long or too far in the future); proposals_refused (inconsistent proposals in a round
  /// of local search). With an external planner: external_rounds (rounds answered in time),
  /// external_missing (rounds without an answer), external_late (answers after the deadline),
  /// external_unasked (answers without a request, or duplicates), external_refused (answers that
  /// are not valid plans; unsafe plans count as plan_checks_failed). With shared slots:
  /// yielded_rounds. bodies_dropped: bodies in the way beyond the number that a plan can avoid.
  /// rounds_short_of_processor: rounds in which a robot with a driver brakes instead of searching,
  /// because its planner gets too little processor time.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  [[nodiscard]] std::int64_t deadlines_missed() const override { return late_; }

 private:
  /// Calls take() for each message on `channel` that names `robot`; counts the others.
  template <class Message>
  void subscribe_to(const bus::Channel<Message>& channel, const std::string& robot,
                    std::function<void(const Message&)> take);
  void take_frame(const std::shared_ptr<const models::MocapFrame>& frame);
  /// Makes the newest mocap frame an input, and also an earlier frame if bodies are in the way.
  void use_frames();
  void take_plan(const models::RobotPlan& plan);
  [[nodiscard]] Deadline deadline_of(Time now) const;
  /// True if the process waits so long for a processor that a vehicle must not rely on its next
  /// plan.
  [[nodiscard]] bool is_short_of_processor() const;
  void propose(Time now);
  /// Local search: starts the exchange of the slot's round.
  void begin_exchange(Time now);
  /// Continues the local search for a limited time and publishes its result.
  void exchange(Time now);
  void subscribe_to_status(const std::string& name);
  void subscribe_to_teammate(const std::string& name);
  void take_proposal(const models::TeamProposal& proposal);
  /// Requests the slot's plan from the external process; false if no request can be made.
  bool request_plan(Time now);
  void take_answer(const models::RobotPlan& answer);
  void plan(Time now);
  /// Selects the robot's first slot that begins after `after`.
  void move_on(Time after);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::shared_ptr<Workspace> workspace_;
  const scenario::PlannerSpec& spec_;
  const std::vector<scenario::RobotSpec>& robots_;
  std::string robot_;
  RobotPlanner planner_;
  RoundSchedule schedule_;
  RoundSchedule::Slot slot_;
  PlanInputs inputs_;
  Time attack_received_{};
  std::shared_ptr<const models::MocapFrame> mocap_;  ///< newest frame; input once the slot begins
  /// Earlier frames, at least kVelocityTime apart, for the velocity of bodies.
  std::shared_ptr<const models::MocapFrame> mocap_before_, mocap_between_;
  std::optional<models::BeliefMixture> mixture_;  ///< newest mixture; arrives before its belief
  std::optional<bus::NeighbourWatch> neighbours_;
  // State of an exchange:
  std::unique_ptr<TeamExchange> exchange_;  ///< exchange started last
  Time next_exchange_ = Time::max();
  Time exchange_end_{};
  std::vector<models::InputRef> exchange_inputs_;  ///< inputs of the candidates
  std::map<std::string, models::TeamProposal>
      newest_proposals_;  ///< newest proposal of each teammate
  // State of a request with planner.algorithm `external`.
  bool is_request_pending_ = false;
  Time answer_due_{};  ///< deadline of the answer; then the robot plans without it
  std::int64_t requested_round_ = -1;
  std::int64_t answers_ = 0;
  std::int64_t answers_missing_ = 0;
  std::int64_t answers_late_ = 0;
  std::int64_t answers_unsolicited_ = 0;
  std::int64_t proposals_refused_ = 0;
  std::int64_t late_ = 0;
  std::int64_t slots_skipped_ = 0;
  std::int64_t short_of_processor_ = 0;
  double processor_wait_s_ = 0.0;  ///< time waiting for a processor during the last second
  std::int64_t misaddressed_ = 0;
  std::int64_t unusable_plans_ = 0;
};

/// Returns references to the messages in `inputs`, in a fixed order.
std::vector<models::InputRef> names_of(const PlanInputs& inputs, const std::string& robot);

}  // namespace vantage::planner
