#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/external_channels.hpp"
#include "models/plan/plan.hpp"
#include "planner/app/replay_node.hpp"
#include "planner/robot/external_answer.hpp"
#include "test/planner/app/node_fixture.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::planner {
namespace {

using namespace std::chrono_literals;
using vantage::test::sent_ref;

constexpr Duration kClosing = 20ms;  // time reserved at the end of a slot of 100 ms or more

using Answer = std::function<std::vector<models::RobotPlan>(const models::RobotPlan& question)>;

scenario::Scenario external_scenario() {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.algorithm = "external";
  return scenario;
}

models::RobotPlan drive(const models::RobotPlan& question, double speed_mps, double duration_s) {
  models::RobotPlan answer = question;
  answer.trajectory.segments = {{{speed_mps, 0.0}, duration_s, 0.0}};
  return answer;
}

// The external planner at the other end of the bus, which replies with a given answer.
class ExternalTest : public test::PlannerNodeTest {
 protected:
  void start_with(const Answer& answer) {
    start(external_scenario());
    world_.subscribe<models::RobotPlan>(
        bus::external_request_channel("Q1"), [this, answer](const auto& question) {
          questions_.push_back(question);
          asked_at_ = clock_.now();
          for (const models::RobotPlan& each : answer(question)) {
            answers_.push_back(sent_ref(world_, bus::external_plan_channel("Q1"), each));
          }
        });
    world_.subscribe<models::RobotPlan>(bus::plan_channel("Q1"),
                                        [this](const auto&) { published_at_ = clock_.now(); });
    world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
    round();
  }

  std::vector<models::RobotPlan> questions_;
  std::vector<models::InputRef> answers_;
  Time asked_at_{};
  Time published_at_{};
};

TEST_F(ExternalTest, PublishesAnswerImmediatelyAndAppendsAStop) {
  start_with([](const auto& question) { return std::vector{drive(question, 0.5, 1.0)}; });
  ASSERT_EQ(questions_.size(), 1U);
  const models::RobotPlan& question = questions_[0];
  EXPECT_EQ(question.source, models::PlanSource::kShifted);
  EXPECT_EQ(question.trajectory.start_time, inputs_.slot.activation);
  EXPECT_EQ(question.horizon_steps, scenario_.planner.horizon_steps);
  EXPECT_GT(question.deadline, inputs_.slot.begin);
  EXPECT_LT(question.deadline, inputs_.slot.end);
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(published_at_, asked_at_) << "teammates can use the rest of the slot";
  EXPECT_EQ(plans_[0].source, models::PlanSource::kSearched);
  ASSERT_EQ(plans_[0].trajectory.segments.size(), 2U);
  EXPECT_EQ(plans_[0].trajectory.segments[1].brake_mps2, scenario_.robots[0].limits.brake_mps2);
  EXPECT_EQ(plans_[0].inputs.back(), answers_[0]);
  EXPECT_EQ(count("external_rounds"), 1);
  EXPECT_EQ(count("fallbacks_shifted"), 0);
}

TEST_F(ExternalTest, FallsBackInTimeWithoutAnswer) {
  start_with([](const auto&) { return std::vector<models::RobotPlan>{}; });
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].source, models::PlanSource::kShifted);
  EXPECT_EQ(published_at_, questions_[0].deadline);
  EXPECT_LT(published_at_, inputs_.slot.end);
  EXPECT_EQ(count("external_missing"), 1);
  EXPECT_EQ(count("fallbacks_shifted"), 1);
  EXPECT_FALSE(plans_[0].late);
}

// A planner that is woken after the deadline for answers sends no request and uses its own plan.
TEST_F(ExternalTest, SendsNoRequestAfterAnswerDeadline) {
  start(external_scenario());
  world_.subscribe<models::RobotPlan>(
      bus::external_request_channel("Q1"),
      [this](const auto& question) { questions_.push_back(question); });
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  clock_.set(inputs_.slot.end - Duration{1});
  node_->tick(clock_.now());
  deliver();
  EXPECT_TRUE(questions_.empty());
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].source, models::PlanSource::kShifted);
  EXPECT_EQ(count("fallbacks_shifted"), 1);
  EXPECT_EQ(count("external_missing"), 0) << "no request was sent";
  const Duration round = from_seconds(1.0);
  const Time due = inputs_.slot.end - kClosing;
  for (const auto& [now, requests] : {std::pair(due + round, 0U), {due + 2 * round - 1us, 1U}}) {
    clock_.set(now);
    node_->tick(now);
    deliver();
    EXPECT_EQ(questions_.size(), requests);
  }
}

TEST_F(ExternalTest, SendsRequestAtSlotBegin) {
  start_with([](const auto& question) { return std::vector{drive(question, 0.5, 1.0)}; });
  ASSERT_EQ(questions_.size(), 1U);
  const models::InputRef belief{"BELIEF_Q1", 100, 0};
  const models::InputRef mocap{"VICON", 100, 0};
  EXPECT_EQ(asked_at_, inputs_.slot.begin);
  EXPECT_EQ(questions_[0].finish, inputs_.slot.begin);
  EXPECT_EQ(questions_[0].deadline, inputs_.slot.end - kClosing);
  EXPECT_EQ(questions_[0].inputs, (std::vector{belief, mocap}));
  inputs_.slot.activation += from_seconds(1.0);
  inputs_.mocap->stamp.time += from_seconds(1.0);
  world_.publish(bus::kVicon, *inputs_.mocap);
  round();
  ASSERT_EQ(questions_.size(), 2U);
  EXPECT_EQ(questions_[1].inputs,
            (std::vector<models::InputRef>{belief, {"VICON", 100, 1}, {"PLAN_Q1", 1, 0}}));
}

TEST_F(ExternalTest, ContinuesItsPlanWithoutAnAnswer) {
  bool answers = true;
  start_with([&](const auto& question) {
    return answers ? std::vector{drive(question, 0.5, 1.0)} : std::vector<models::RobotPlan>{};
  });
  for (const bool is_answered : {false, true, false}) {
    answers = is_answered;
    inputs_.slot.activation += from_seconds(1.0);
    round();
    EXPECT_EQ(plans_.back().source == models::PlanSource::kSearched, is_answered);
    EXPECT_EQ(plans_.back().inputs.back().channel == "EXTERNAL_PLAN_Q1", is_answered);
  }
  EXPECT_EQ(count("external_rounds"), 2);
  EXPECT_EQ(count("external_missing"), 2);
  world_.publish(bus::external_plan_channel("Q1"), drive(questions_[0], 0.5, 1.0));
  deliver();
  EXPECT_EQ(count("external_late"), 1) << "a round that ended long ago";
}

// The planner is woken only after the slot, but it sent its request in time. The slot does not
// count as skipped.
TEST_F(ExternalTest, PlansAtTheEndOfItsSlotAfterARequest) {
  start(external_scenario());
  world_.publish(bus::belief_channel("Q1"), *inputs_.belief);
  deliver();
  for (const Time now : {inputs_.slot.begin, inputs_.slot.end + 1us}) {
    clock_.set(now);
    node_->tick(now);
    deliver();
  }
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].source, models::PlanSource::kShifted);
  EXPECT_EQ(count("slots_skipped"), 0);
  EXPECT_EQ(count("external_missing"), 1);
}

TEST_F(ExternalTest, CountsLateAndUnrequestedAnswers) {
  start_with([](const auto&) { return std::vector<models::RobotPlan>{}; });
  const models::RobotPlan late = drive(questions_[0], 0.5, 1.0);
  world_.publish(bus::external_plan_channel("Q1"), late);
  models::RobotPlan early = late;
  early.round += 7;
  world_.publish(bus::external_plan_channel("Q1"), early);
  early.robot = "Q2";
  world_.publish(bus::external_plan_channel("Q1"), early);
  deliver();
  EXPECT_EQ(count("external_late"), 1);
  EXPECT_EQ(count("external_unasked"), 1);
  EXPECT_EQ(count("misaddressed"), 1);
  EXPECT_EQ(plans_.size(), 1U);
}

TEST_F(ExternalTest, AcceptsTheFirstAnswerPerRound) {
  start_with([](const auto& question) {
    return std::vector{drive(question, 0.5, 1.0), drive(question, 0.25, 1.0)};
  });
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].trajectory.segments[0].control.speed_mps, 0.5);
  EXPECT_EQ(count("external_unasked"), 1);
  inputs_.slot.activation += from_seconds(1.0);
  round();
  ASSERT_EQ(plans_.size(), 2U);
  EXPECT_EQ(questions_[1].round, questions_[0].round + 1);
  EXPECT_EQ(questions_[1].trajectory.start_time, inputs_.slot.activation);
}

TEST_F(ExternalTest, FallsBackOnAnUnsafeAnswer) {
  start_with([](const auto& question) { return std::vector{drive(question, 1.0, 5.0)}; });
  ASSERT_EQ(plans_.size(), 1U);
  EXPECT_EQ(plans_[0].source, models::PlanSource::kShifted);
  EXPECT_EQ(count("plan_checks_failed"), 1);
  EXPECT_EQ(count("external_missing"), 0);
}

TEST_F(ExternalTest, IsReplayedFromItsInputs) {
  start_with([](const auto& question) { return std::vector{drive(question, 0.5, 1.0)}; });
  RobotPlanner planner(scenario_, "Q1");
  PlanInputs inputs = inputs_;
  inputs.answer = drive(questions_[0], 0.5, 1.0);
  const auto again = planner.plan(inputs, Deadline::nodes(0));
  ASSERT_TRUE(again);
  EXPECT_TRUE(is_same_decision(*again, plans_[0]));
}

// The plan drives straight at a box, 1.2 m away. The planner accepts a stop up to 2 cm inside the
// clearance that searches keep, and refuses a stop that is closer.
TEST(RobotPlanner, RefusesAnAnswerTwoCentimetresInsideItsMargin) {
  scenario::Scenario scenario = external_scenario();
  scenario.robots.resize(1);
  scenario.robots[0].start = {-3.0, 0.8, 0.0};
  const models::VehicleLimits& limits = scenario.robots[0].limits;
  const double margin_m = limits.radius_m + scenario.planner.obstacle_margin_m;
  const double speed_mps = 0.5;
  const double stop_m = 0.5 * speed_mps * speed_mps / limits.brake_mps2;
  for (const double nearer_m : {-0.1, 0.0, 0.018, 0.022, 0.1}) {
    PlanInputs inputs = test::first_inputs(scenario, 0, 5);
    RobotPlanner planner(scenario, "Q1");
    const auto question = planner.external_request(inputs);
    ASSERT_TRUE(question);
    inputs.answer = drive(*question, speed_mps, (1.2 - margin_m + nearer_m - stop_m) / speed_mps);
    const auto plan = planner.plan(inputs, Deadline::nodes(0));
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->source == models::PlanSource::kSearched, nearer_m < 0.02) << nearer_m;
  }
}

// Changes each field of a valid answer so that the vehicle cannot fly it.
TEST(MotionOfAnswer, RefusesInfeasibleMotions) {
  const scenario::Scenario scenario = external_scenario();
  const models::VehicleLimits& limits = scenario.robots[0].limits;
  models::RobotPlan question;
  question.trajectory.start_time = Time{Duration{5'000'000}};
  question.trajectory.start = {1.0, 2.0, 3.14};
  question.trajectory.height_m = 1.0;
  const models::RobotPlan good = drive(question, 0.5, 1.0);
  const auto motion = [&](const models::RobotPlan& answer) {
    return motion_of_answer(answer, question.trajectory, scenario.planner, limits);
  };
  ASSERT_TRUE(motion(good));
  EXPECT_EQ(motion(good)->segments.size(), 2U);
  EXPECT_TRUE(motion(question)) << "a hover is a plan";

  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(models::Trajectory&)>> spoilers = {
      [](auto& t) { t.start_time += Duration{1}; },
      [](auto& t) { t.start.x_m += 0.002; },
      [](auto& t) { t.start.yaw_rad = -3.14; },
      [](auto& t) { t.start.yaw_rad -= 0.002; },
      [](auto& t) { t.height_m += 0.01; },
      [](auto& t) { t.height_m -= 0.01; },
      [&](auto& t) { t.start.y_m = kNan; },
      [&](auto& t) { t.segments[0].control.speed_mps = 1.001 * limits.speed_max_mps; },
      [](auto& t) { t.segments[0].control.speed_mps = -0.1; },
      [&](auto& t) { t.segments[0].control.speed_mps = kNan; },
      [&](auto& t) { t.segments[0].control.yaw_rate_radps = -1.001 * limits.yaw_rate_max_radps; },
      [](auto& t) { t.segments[0].duration_s = 0.0; },
      [&](auto& t) { t.segments[0].duration_s = kNan; },
      [](auto& t) { t.segments[0].duration_s = 6.001; },
      [&](auto& t) { t.segments.assign(49, t.segments[0]); },
      [&](auto& t) { t.segments[0].brake_mps2 = 1.001 * limits.brake_mps2; },
      [](auto& t) { t.segments[0].brake_mps2 = 0.6; },  // speed would become negative
      [](auto& t) {
        t.segments[0] = {{0.5, 0.1}, 0.2, 0.5};
      },
  };
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    models::RobotPlan bad = good;
    spoilers[i](bad.trajectory);
    EXPECT_FALSE(motion(bad)) << "spoiler " << i;
  }
  models::RobotPlan near = good;
  near.trajectory.start.x_m += 5e-4;
  near.trajectory.start.yaw_rad -= 2.0 * kPi;
  near.trajectory.segments.push_back(models::brake(0.5, 1.0).front());
  ASSERT_TRUE(motion(near));
  EXPECT_EQ(motion(near)->start.x_m, 1.0) << "from its committed position";
  EXPECT_EQ(motion(near)->segments.size(), 2U) << "it already ends in a stop";
}

}  // namespace
}  // namespace vantage::planner
