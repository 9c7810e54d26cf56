#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "planner/app/replay_node.hpp"

// Two decisions are the same when every number of the motion and of its certificate has the same
// bits. The tests change one number at a time; in a list, the last number.

namespace vantage::planner {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

models::Trajectory motion() {
  models::Trajectory motion;
  motion.start_time = Time{Duration{5'000'000}};
  motion.start = {1.0, 2.0, 3.0};
  motion.height_m = 1.5;
  motion.segments = {{{0.5, 0.25}, 1.0, 0.0}, {{0.25, -0.5}, 2.0, 0.0}, {{0.125, 0.0}, 4.0, 0.5}};
  return motion;
}

using Spoil = std::function<void(models::Trajectory&)>;

std::vector<Spoil> other_motions() {
  std::vector<Spoil> others = {
      [](auto& t) { t.start_time += Duration{1}; },
      [](auto& t) { t.start.x_m = -1.0; },
      [](auto& t) { t.start.y_m = -2.0; },
      [](auto& t) { t.start.yaw_rad = -3.0; },
      [](auto& t) { t.height_m = 1.0; },
      [](auto& t) { t.segments.pop_back(); },
      [](auto& t) { t.segments.push_back({}); },
  };
  for (std::size_t i = 0; i < motion().segments.size(); ++i) {
    others.insert(others.end(), {
                                    [i](auto& t) { t.segments[i].control.speed_mps *= -1.0; },
                                    [i](auto& t) { t.segments[i].control.yaw_rate_radps += 0.1; },
                                    [i](auto& t) { t.segments[i].duration_s *= 2.0; },
                                    [i](auto& t) { t.segments[i].brake_mps2 += 0.25; },
                                });
  }
  return others;
}

models::RobotPlan plan() {
  models::RobotPlan plan;
  plan.stamp = {Time{Duration{5'000'000}}, 1, 2};
  plan.robot = "Q1";
  plan.round = 7;
  plan.source = models::PlanSource::kSearched;
  plan.trajectory = motion();
  plan.cost = -3.0;
  plan.lower_bound = -4.0;
  plan.epsilon = 0.5;
  plan.delta_m = 0.25;
  plan.passes = 3;
  return plan;
}

TEST(IsSameDecision, ComparesMotionAndCertificateOfPlan) {
  std::vector<std::function<void(models::RobotPlan&)>> others = {
      [](auto& p) { p.robot = "Q2"; },
      [](auto& p) { ++p.round; },
      [](auto& p) { p.source = models::PlanSource::kShifted; },
      [](auto& p) { p.cost = 3.0; },
      [](auto& p) { p.cost = kNan; },
      [](auto& p) { p.lower_bound = -5.0; },
      [](auto& p) { p.epsilon = 0.25; },
      [](auto& p) { p.delta_m = 0.5; },
      [](auto& p) { ++p.passes; },
  };
  for (const Spoil& spoil : other_motions()) {
    others.emplace_back([spoil](models::RobotPlan& p) { spoil(p.trajectory); });
  }
  EXPECT_TRUE(is_same_decision(plan(), plan()));
  for (std::size_t i = 0; i < others.size(); ++i) {
    models::RobotPlan other = plan();
    others[i](other);
    EXPECT_FALSE(is_same_decision(plan(), other)) << i;
    EXPECT_FALSE(is_same_decision(other, plan())) << i;
    EXPECT_TRUE(is_same_decision(other, other)) << i;
  }
}

TEST(IsSameDecision, IgnoresTimesAndInputsOfPlan) {
  models::RobotPlan other = plan();
  other.stamp = {Time{Duration{1}}, 8, 9};
  other.nodes = 1'000;
  other.slot_start = other.deadline = other.finish = Time{Duration{1}};
  other.late = true;
  other.inputs = {{"VICON", 1, 2}};
  EXPECT_TRUE(is_same_decision(plan(), other));
}

// A plan without a search has cost NaN, which counts as equal. Zeros of different sign differ.
TEST(IsSameDecision, ComparesCostsAndPositionsBitByBit) {
  models::RobotPlan none = plan();
  none.cost = kNan;
  EXPECT_TRUE(is_same_decision(none, none));
  models::RobotPlan zero = plan();
  zero.trajectory.start.x_m = 0.0;
  models::RobotPlan minus = zero;
  minus.trajectory.start.x_m = -0.0;
  EXPECT_FALSE(is_same_decision(zero, minus));
}

models::TeamProposal proposal() {
  models::TeamProposal proposal;
  proposal.robot = "Q1";
  proposal.round = 7;
  proposal.value_nats = 2.0;
  proposal.choices = {{"Q1", motion(), 1.0, 0.5}, {"Q3", motion(), 3.0, 0.25}};
  proposal.history = {11, 12};
  return proposal;
}

TEST(IsSameDecision, ComparesSolutionAndHistoryOfProposal) {
  std::vector<std::function<void(models::TeamProposal&)>> others = {
      [](auto& p) { p.robot = "Q2"; },
      [](auto& p) { ++p.round; },
      [](auto& p) { p.value_nats = -2.0; },
      [](auto& p) { p.history = {11}; },
      [](auto& p) {
        p.history = {11, 13};
      },
      [](auto& p) {
        p.history = {10, 12};
      },
      [](auto& p) { p.choices.pop_back(); },
      [](auto& p) { p.choices.push_back({}); },
      [](auto& p) { std::swap(p.choices[0], p.choices[1]); },
  };
  for (std::size_t i = 0; i < proposal().choices.size(); ++i) {
    others.insert(others.end(), {
                                    [i](auto& p) { p.choices[i].robot = "Q2"; },
                                    [i](auto& p) { p.choices[i].information_nats += 1.0; },
                                    [i](auto& p) { p.choices[i].energy_nats += 1.0; },
                                });
    for (const Spoil& spoil : other_motions()) {
      others.emplace_back([spoil, i](auto& p) { spoil(p.choices[i].trajectory); });
    }
  }
  EXPECT_TRUE(is_same_decision(proposal(), proposal()));
  for (std::size_t i = 0; i < others.size(); ++i) {
    models::TeamProposal other = proposal();
    others[i](other);
    EXPECT_FALSE(is_same_decision(proposal(), other)) << i;
    EXPECT_FALSE(is_same_decision(other, proposal())) << i;
  }
  models::TeamProposal other = proposal();
  other.stamp = {Time{Duration{1}}, 8, 9};
  other.nodes = 1'000;
  other.inputs = {{"VICON", 1, 2}};
  EXPECT_TRUE(is_same_decision(proposal(), other));
}

}  // namespace
}  // namespace vantage::planner
