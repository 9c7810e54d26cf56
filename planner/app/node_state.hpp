#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/deadline.hpp"
#include "planner/robot/plan_inputs.hpp"
#include "planner/robot/robot_planner.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// State that a planner node shares with its PlanMode.
struct NodeState {
  bus::Bus& bus;
  const bus::Clock& clock;
  std::string robot;
  const scenario::PlannerSpec& spec;
  RobotPlanner planner;
  PlanInputs inputs{};  ///< `slot` is the present or next slot
  // Counters that PlannerNode::counters() reports.
  std::int64_t plans_late = 0;
  std::int64_t misaddressed = 0;
  std::int64_t proposals_refused = 0;
  std::int64_t answers = 0;
  std::int64_t answers_missing = 0;
  std::int64_t answers_late = 0;
  std::int64_t answers_unasked = 0;

  /// Calls take() for each message on `channel` that names the robot `sender`; counts the others.
  template <class Message, class Take>
  void subscribe(const bus::Channel<Message>& channel, const std::string& sender, Take take);
  /// Returns the time at which the work of the slot must end, so that its result is checked and
  /// sent before the slot ends.
  [[nodiscard]] Time work_end() const;
  [[nodiscard]] std::int64_t node_budget() const;
  /// Returns the deadline of a search that begins at `now`.
  [[nodiscard]] Deadline deadline(Time now) const;
  /// Returns the completion time to write into the result of a search.
  [[nodiscard]] Time finish() const { return clock.is_real_time() ? clock.now() : work_end(); }
};

/// Returns references to the messages in `inputs`, in a fixed order.
std::vector<models::InputRef> names_of(const PlanInputs& inputs, const std::string& robot);

template <class Message, class Take>
void NodeState::subscribe(const bus::Channel<Message>& channel, const std::string& sender,
                          Take take) {
  const auto robot_of = [](const auto& message) -> const std::string& {
    if constexpr (requires { message.robot; }) {
      return message.robot;
    } else {
      return message.plan.robot;
    }
  };
  bus.subscribe<Message>(channel,
                         [this, robot_of, sender, take = std::move(take)](const Message& message) {
                           if (robot_of(message) == sender) {
                             take(message);
                           } else {
                             ++misaddressed;
                           }
                         });
}

}  // namespace vantage::planner
