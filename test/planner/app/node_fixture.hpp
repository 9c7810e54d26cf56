#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/transport/transport.hpp"
#include "planner/app/node.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner::test {

/// A planner node of Q1 on an in-process bus, and a second bus end that publishes its inputs.
class PlannerNodeTest : public ::testing::Test {
 protected:
  void deliver() {
    while (world_.handle(std::chrono::microseconds(0)) +
               robot_bus_.handle(std::chrono::microseconds(0)) >
           0) {
    }
  }

  void start(const scenario::Scenario& scenario) { start(scenario, clock_); }

  /// Starts the node with a clock other than the one that round() sets.
  void start(const scenario::Scenario& scenario, const bus::Clock& clock) {
    scenario_ = scenario;
    inputs_ = first_inputs(scenario, 0, 5);
    clock_.set(inputs_.slot.activation - from_seconds(1.0));
    node_ = std::make_unique<PlannerNode>(robot_bus_, clock, scenario, "Q1");
    world_.subscribe<models::RobotPlan>(bus::plan_channel("Q1"),
                                        [this](const auto& plan) { plans_.push_back(plan); });
    world_.publish(bus::kVicon, *inputs_.mocap);
    inputs_.belief->robot = "Q1";
  }

  // Runs all ticks of the node that are due within the round.
  void round() {
    deliver();
    while (node_->next_tick() < inputs_.slot.activation) {
      clock_.set(node_->next_tick());
      node_->tick(clock_.now());
      deliver();
    }
  }

  [[nodiscard]] models::RobotPlan plan_of(const std::string& robot) const {
    models::RobotPlan plan;
    plan.stamp.time = inputs_.slot.activation;
    plan.robot = robot;
    plan.round = inputs_.slot.round;
    plan.lower_bound = -1.0;
    plan.trajectory = {plan.stamp.time, scenario_.find_robot("Q2")->start, 1.5, {}};
    return plan;
  }

  [[nodiscard]] std::int64_t count(const std::string& name) const {
    for (const auto& counters : {node_->counters(), robot_bus_.counters()}) {
      for (const models::NamedCount& counter : counters) {
        if (counter.name == name) {
          return counter.count;
        }
      }
    }
    return 0;
  }

  bus::VirtualClock clock_{Time{}};
  bus::InProcessHub hub_;
  std::unique_ptr<bus::Transport> world_end_ = hub_.connect();
  std::unique_ptr<bus::Transport> robot_end_ = hub_.connect();
  bus::Bus world_{*world_end_, 100};
  bus::Bus robot_bus_{*robot_end_, 1};
  scenario::Scenario scenario_;
  PlanInputs inputs_;
  std::unique_ptr<PlannerNode> node_;
  std::vector<models::RobotPlan> plans_;
};

}  // namespace vantage::planner::test
