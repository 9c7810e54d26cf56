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

/// Joins a RobotPlanner to the bus: BELIEF_R with its MIXTURE_R (and MAP_R where the team maps),
/// VICON, teammates' PLAN_* and ATTACK in, PLAN_R out, once a round in this robot's slot; in a team
/// that expects attacks PROPOSAL_* besides, in and out; in one that plans by local search
/// TEAM_PROPOSAL_*; of planner.algorithm `external` EXTERNAL_REQUEST_R out and EXTERNAL_PLAN_R in.
///
/// In a neighbourhood (network.neighbourhood_m) only teammates within it are listened to.
///
/// Under a clock that is not real time the budget is planner.node_budget nodes.
class PlannerNode : public bus::Node {
 public:
  PlannerNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
              const std::string& robot);
  /// One of several that run in turn in one thread and share a workspace.
  PlannerNode(bus::Bus& bus, const bus::Clock& clock, std::shared_ptr<Workspace> workspace,
              const std::string& robot);

  [[nodiscard]] std::string name() const override { return "PLANNER_" + robot_; }
  [[nodiscard]] Time next_tick() const override {
    return is_asking_ ? answer_due_ : std::min(slot_.begin, next_exchange_);
  }
  void tick(Time now) override;
  void on_processor_wait(double wait_s) override { processor_wait_s_ = wait_s; }
  /// Those of the planner, and: slots_skipped, misaddressed (a robot's name inside a message is not
  /// that of its channel), unusable_plans (of teammates: too long, or for the far future),
  /// proposals_refused (of the round of a local search, that cannot be). Where another process is
  /// asked for plans: external_rounds (with an answer in time), external_missing (without),
  /// external_late (answers after it), external_unasked (of no round that was asked for, or one
  /// more), external_refused (no plan of their slot; those that are unsafe are plan_checks_failed).
  /// Where slots are shared: yielded_rounds. Where there were more bodies in the way than a plan
  /// can keep from: bodies_dropped. Of a robot with a driver: rounds_short_of_processor (it brakes
  /// instead of searching).
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  [[nodiscard]] std::int64_t deadlines_missed() const override { return late_; }

 private:
  /// Calls take() with each message on `channel` that is of `robot`; counts the others.
  template <class Message>
  void subscribe_to(const bus::Channel<Message>& channel, const std::string& robot,
                    std::function<void(const Message&)> take);
  void take_frame(const std::shared_ptr<const models::MocapFrame>& frame);
  /// Makes the newest frame an input, and an earlier one where bodies are in the way.
  void use_frames();
  void take_plan(const models::RobotPlan& plan);
  [[nodiscard]] Deadline deadline_of(Time now) const;
  /// The process waits so long for a processor that a vehicle must not count on its next plan.
  [[nodiscard]] bool is_short_of_processor() const;
  void propose(Time now);
  /// Local search: begins the exchange of the slot's round.
  void begin_exchange(Time now);
  /// Searches for a while, publishes what it has found.
  void exchange(Time now);
  void listen_to_status_of(const std::string& name);
  void listen_to(const std::string& name);
  void hear(const models::TeamProposal& proposal);
  /// Asks the process on the bus for the slot's plan; false when nothing can be asked (any more).
  bool ask(Time now);
  void hear_answer(const models::RobotPlan& answer);
  void plan(Time now);
  /// Waits for the robot's first slot after that time.
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
  Time attack_heard_{};
  std::shared_ptr<const models::MocapFrame> mocap_;  ///< newest; of inputs_ from the slot on
  /// Earlier ones, at least kVelocityTime apart from each other: by them bodies move.
  std::shared_ptr<const models::MocapFrame> mocap_before_, mocap_between_;
  std::optional<models::BeliefMixture> mixture_;  ///< newest; its belief comes after it
  std::optional<bus::NeighbourWatch> neighbours_;
  // Of an exchange:
  std::unique_ptr<TeamExchange> exchange_;  ///< the last that was begun
  Time next_exchange_ = Time::max();
  Time exchange_end_{};
  std::vector<models::InputRef> exchange_inputs_;          ///< what the candidates were made from
  std::map<std::string, models::TeamProposal> overheard_;  ///< newest of each teammate
  // Of planner.algorithm `external`:
  bool is_asking_ = false;
  Time answer_due_{};  ///< then the robot goes on without one
  std::int64_t asked_round_ = -1;
  std::int64_t answers_ = 0;
  std::int64_t answers_missing_ = 0;
  std::int64_t answers_late_ = 0;
  std::int64_t answers_unasked_ = 0;
  std::int64_t proposals_refused_ = 0;
  std::int64_t late_ = 0;
  std::int64_t slots_skipped_ = 0;
  std::int64_t short_of_processor_ = 0;
  double processor_wait_s_ = 0.0;  ///< within the last second
  std::int64_t misaddressed_ = 0;
  std::int64_t unusable_plans_ = 0;
};

/// The messages that `inputs` consists of, by name, in a fixed order.
std::vector<models::InputRef> names_of(const PlanInputs& inputs, const std::string& robot);

}  // namespace vantage::planner
