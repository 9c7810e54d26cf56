#include "drivers/safety/guard_core.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/limits.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;

scenario::Scenario room() {
  scenario::Scenario out;
  out.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.world.ceiling_m = 3.0;
  scenario::RobotSpec robot;
  robot.name = "Q1";
  robot.height_m = 1.0;
  robot.limits = {1.0, 3.0, 2.0, 0.25};
  out.robots.push_back(robot);
  return out;
}

GuardCore core_of_q1(const scenario::Scenario& scenario) {
  return {scenario, "Q1", limits_for(scenario, "Q1"), {conditions()}, Course(0.25)};
}

// The safest of several commands in a tick is kept, in any order of arrival. The next tick starts
// without a command.
TEST(GuardCore, KeepsTheSafestCommandOfATick) {
  const scenario::Scenario scenario = room();
  GuardCore core = core_of_q1(scenario);
  std::vector<OperatorAction> orders = {OperatorAction::kFollow, OperatorAction::kHold,
                                        OperatorAction::kLand};
  Time now = from_utime(1'000'000);
  do {
    for (const OperatorAction order : orders) {
      EXPECT_EQ(core.request_action(order), CommandVerdict::kObeyed);
    }
    core.update_common_inputs(now);
    EXPECT_EQ(core.inputs().request, OperatorAction::kLand);
    (void)core.end_tick({}, now);
    now += from_seconds(0.02);
    core.update_common_inputs(now);
    EXPECT_EQ(core.inputs().request, std::nullopt) << "a processed command is cleared";
  } while (std::next_permutation(orders.begin(), orders.end()));
}

// A heartbeat requests no action and is processed immediately.
TEST(GuardCore, ExecutesStatelessCommandsImmediately) {
  const scenario::Scenario scenario = room();
  GuardCore core = core_of_q1(scenario);
  models::OperatorCommand command;
  const auto answer = [&](OperatorAction action, const std::string& robot) {
    command.action = action;
    command.robot = robot;
    return core.execute_if_stateless(command);
  };
  const auto inputs = [&core] {
    core.update_common_inputs(from_utime(1'000'000));
    return core.inputs();
  };
  EXPECT_EQ(answer(OperatorAction::kHeartbeat, ""), CommandVerdict::kObeyed);
  EXPECT_EQ(answer(OperatorAction::kHeartbeat, "Q1"), CommandVerdict::kObeyed);
  EXPECT_EQ(answer(OperatorAction::kEmergencyStop, "Q2"), CommandVerdict::kOtherRobot);
  EXPECT_FALSE(inputs().emergency_stop);
  for (const OperatorAction action :
       {OperatorAction::kArm, OperatorAction::kTakeOff, OperatorAction::kFollow,
        OperatorAction::kHold, OperatorAction::kLand}) {
    EXPECT_EQ(answer(action, ""), std::nullopt) << static_cast<int>(action);
  }
  EXPECT_FALSE(inputs().emergency_stop);
  EXPECT_EQ(answer(OperatorAction::kEmergencyStop, ""), CommandVerdict::kObeyed);
  EXPECT_TRUE(inputs().emergency_stop);
  EXPECT_FALSE(inputs().request);
}

/// Q1 as seen by successive mocap publishers.
class GuardCoreWithMocap : public testing::Test {
 protected:
  /// Delivers a frame at the time `now` and returns whether its publisher is accepted. The frame
  /// took `latency_s` from its stamp to the mocap driver, and then `way_s` to this process.
  bool see(std::int64_t run_id, const Eigen::Vector3d& place_m, bool is_armed = false,
           BodyContext context = {}) {
    models::MocapFrame frame;
    frame.arrival = now - from_seconds(way_s) + from_seconds(clock_s);
    frame.stamp = {frame.arrival - from_seconds(latency_s), run_id, number};
    frame.frame_number = number++;
    frame.bodies.push_back({"Q1", {place_m, Quaternion::Identity()}, false});
    return core.on_mocap(frame, context, is_armed, now);
  }
  bool is_at(const Eigen::Vector3d& place_m) {
    return core.pose().world_from_body().translation_m == place_m;
  }
  [[nodiscard]] std::int64_t clocks_set() const {
    std::vector<models::NamedCount> counts;
    core.count(counts);
    const auto found = std::find_if(counts.begin(), counts.end(), [](const auto& each) {
      return each.name == "mocap.clock_set";
    });
    return found == counts.end() ? -1 : found->count;
  }
  void pass(double seconds) { now += from_seconds(seconds); }

  scenario::Scenario scenario = room();
  GuardCore core = core_of_q1(scenario);
  Time now = from_utime(1'700'000'000'000'000);
  double latency_s = 0.02;
  double way_s = 0.0;
  double clock_s = 0.0;  ///< s; mocap computer's clock minus the local clock
  std::int64_t number = 1;
  const Eigen::Vector3d here_m{0.5, -0.5, 0.0};
  const Eigen::Vector3d far_m{1.5, -0.5, 0.0};
  static constexpr int kFirst = 3;
  static constexpr int kOther = 4;
};

// After arming, a new publisher must show the vehicle at its known position; before arming the
// vehicle may have been carried. The current publisher may show it elsewhere on the ground, but not
// in the air.
TEST_F(GuardCoreWithMocap, NewSourceMustShowTheKnownPositionWhenArmed) {
  for (const bool is_armed : {false, true}) {
    for (const bool in_air : {false, true}) {
      for (const bool is_other : {false, true}) {
        for (const bool is_elsewhere : {false, true}) {
          core = core_of_q1(scenario);
          ASSERT_TRUE(see(kFirst, here_m));
          pass(0.4);
          const Eigen::Vector3d& shown_m = is_elsewhere ? far_m : here_m;
          const bool is_held = in_air || (is_other && is_armed);
          const bool is_believed = !is_elsewhere || !is_held;
          const bool is_heard = see(is_other ? kOther : kFirst, shown_m, is_armed, {in_air});
          EXPECT_EQ(is_heard, is_believed || !is_other) << "the current source stays accepted";
          EXPECT_TRUE(is_at(is_believed ? shown_m : here_m));
          // A refused publisher does not replace the current one, which is still accepted.
          EXPECT_EQ(see(kFirst, here_m), !(is_other && is_believed));
        }
      }
    }
  }
}

// Each clock change is counted once, in either direction; other frames are not counted.
TEST_F(GuardCoreWithMocap, CountsClockChanges) {
  const auto frames = [&] {
    for (int i = 0; i < 20; ++i) {
      pass(0.01);
      ASSERT_TRUE(see(kFirst, here_m));
    }
  };
  frames();
  EXPECT_EQ(clocks_set(), 0);
  std::int64_t times = 0;
  for (const double set_by_s : {-3.0, 3.0, -60.0, 60.0}) {
    clock_s += set_by_s;
    frames();
    EXPECT_EQ(clocks_set(), ++times);
    core.update_common_inputs(now);
    EXPECT_NEAR(core.inputs().pose_latency_s, 0.02, 1e-6)
        << "a clock change does not change the latency";
  }
  latency_s += 0.1;
  frames();
  EXPECT_EQ(clocks_set(), times);
  core.update_common_inputs(now);
  EXPECT_NEAR(core.inputs().pose_latency_s, 0.12, 1e-6);
}

// The latency includes delays in the mocap computer and in the network from the mocap driver.
TEST_F(GuardCoreWithMocap, MeasuresLatencyOfEveryStage) {
  for (int round = 0; round < 2; ++round) {  // repeated with the same state
    for (const double waits_s : {0.0, 0.05, 0.3, 0.9, 0.0}) {
      pass(std::max(0.0, waits_s - way_s));  // no frame arrives while the delay grows
      way_s = waits_s;
      for (int i = 0; i < 20; ++i) {
        pass(0.01);
        ASSERT_TRUE(see(kFirst, here_m));
        core.update_common_inputs(now);
        EXPECT_NEAR(core.inputs().pose_latency_s, 0.02 + waits_s, 1e-6);
      }
    }
  }
  EXPECT_EQ(clocks_set(), 0);
}

// Counts consecutive accepted and consecutive rejected poses; both are 0 without a frame.
TEST_F(GuardCoreWithMocap, CountsAcceptedAndRejectedPoses) {
  core.update_common_inputs(now);
  EXPECT_EQ(core.inputs().poses_accepted, 0);
  EXPECT_EQ(core.inputs().poses_rejected, 0);
  for (int round = 0; round < 2; ++round) {  // repeated with the same state
    const int before = core.inputs().poses_accepted;
    for (int i = 1; i <= 7; ++i) {
      pass(0.01);
      EXPECT_TRUE(see(kFirst, here_m, true, {true}));
      core.update_common_inputs(now);
      EXPECT_EQ(core.inputs().poses_accepted, before + i);
      EXPECT_EQ(core.inputs().poses_rejected, 0);
    }
    for (int i = 1; i <= 5; ++i) {
      pass(0.01);
      EXPECT_TRUE(see(kFirst, far_m, true, {true}));
      core.update_common_inputs(now);
      EXPECT_EQ(core.inputs().poses_accepted, 0);
      EXPECT_EQ(core.inputs().poses_rejected, i);
    }
  }
}

// Only an accepted plan is added to the course.
TEST_F(GuardCoreWithMocap, FollowsAcceptedPlans) {
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.trajectory.start = {here_m.x(), here_m.y(), 0.0};
  plan.trajectory.height_m = 1.0;
  plan.trajectory.segments = {{{0.5, 0.0}, 1.0, 0.0}, models::brake(0.5, 2.0).front()};
  for (const bool may_take : {false, true}) {
    core.course().hover({here_m.x(), here_m.y(), 1.0}, 0.0, now);
    plan.stamp = {now, 100, plan.stamp.sequence + 1};
    plan.trajectory.start_time = now;
    EXPECT_EQ(core.on_plan(plan, may_take, 1.0, now),
              may_take ? PlanVerdict::kAccepted : PlanVerdict::kNotFollowing);
    EXPECT_EQ(core.course().is_on_plan(), may_take);
  }
}

// A vehicle brakes along its plan while its position agrees with the plan, otherwise straight. A
// ground vehicle may have any height, and needs a newer pose.
TEST_F(GuardCoreWithMocap, BrakesAlongThePlanWhileTheVehicleFollowsIt) {
  struct Row {
    bool flies;
    double height_m, unseen_s;
    bool is_along;
  };
  for (const Row& row :
       {Row{true, 1.0, 0.0, true}, Row{true, 0.0, 0.0, false}, Row{false, 0.0, 0.0, true},
        Row{true, 1.0, 0.2, true}, Row{false, 1.0, 0.1, true}, Row{false, 1.0, 0.2, false}}) {
    core = {scenario, "Q1", limits_for(scenario, "Q1"), {conditions(), row.flies}, Course(0.0)};
    core.course().hover({0.0, 0.0, 1.0}, 0.0, now);
    models::RobotPlan plan;
    plan.robot = "Q1";
    plan.stamp = {now, 100, 0};
    plan.trajectory.start_time = now;
    plan.trajectory.height_m = 1.0;
    plan.trajectory.segments = {{{0.5, 1.0}, 3.0, 0.0}, models::brake(0.5, 2.0).front()};
    ASSERT_EQ(core.on_plan(plan, true, 1.0, now), PlanVerdict::kAccepted);
    for (int i = 1; i <= 100; ++i) {
      pass(0.01);
      core.course().advance(now, 0.01, 1.0);
      const Eigen::Vector3d circle_m(0.5 * std::sin(0.01 * i), 0.5 - 0.5 * std::cos(0.01 * i),
                                     row.height_m);
      ASSERT_TRUE(see(kFirst, circle_m, false, {true}));
    }
    pass(row.unseen_s);
    core.course().advance(now, row.unseen_s, 1.0);
    // The plan turns at 1 rad/s during 0.2 s of reaction and 0.25 s of braking at half the rate.
    const double turned_rad = row.is_along ? 0.325 : 0.0;
    EXPECT_NEAR(core.braking_path(now, 0.2).at(1.0).yaw_rad, 1.0 + row.unseen_s + turned_rad, 1e-3)
        << row.flies << " " << row.height_m << " " << row.unseen_s;
  }
}

}  // namespace
}  // namespace vantage::drivers
