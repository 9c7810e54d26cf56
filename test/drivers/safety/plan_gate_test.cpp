#include "drivers/safety/plan_gate.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/inputs.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/bisect.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kSeparationM = 0.5;

Time after(double t_s) { return kStart + from_seconds(t_s); }

/// Plan gate of Q1. The vehicle hovers at (1, −1, 1) with a yaw near π, so that yaw differences
/// cross ±π.
class PlanGateTest : public testing::Test {
 protected:
  PlanGateTest() { course.hover({1.0, -1.0, 1.0}, kYawRad, kStart); }

  /// Returns a new plan of planner run `run`: a hover at the position of the vehicle.
  models::RobotPlan news(double start_s, std::int64_t run = 1) {
    models::RobotPlan plan;
    plan.robot = "Q1";
    plan.round = ++sequence;
    plan.trajectory.start_time = after(start_s);
    plan.trajectory.start = {1.0, -1.0, kYawRad};
    plan.trajectory.height_m = 1.0;
    plan.stamp = {plan.trajectory.start_time, run, sequence};
    return plan;
  }
  PlanVerdict judge(const models::RobotPlan& plan, double at_s) {
    return gate.judge(plan, {may_take, course, height_m, others}, limits, after(at_s), held);
  }
  SafetyInputs report(double at_s) const {
    SafetyInputs out;
    gate.report(after(at_s), limits, out);
    return out;
  }
  /// True if a new gate accepts the plan.
  bool accepts_at_first(const models::RobotPlan& plan, double at_s) {
    gate = PlanGate("Q1");
    return judge(plan, at_s) == PlanVerdict::kAccepted;
  }

  static constexpr double kYawRad = 3.1;
  SafetyLimits limits = limits_for(test::FlightBench::scenario(), "Q1");
  Course course{0.25};
  PlanGate gate{"Q1"};
  bool may_take = true;
  double height_m = 1.0;
  std::vector<OtherCourse> others;
  HeldPlan held;
  std::int64_t sequence = 0;
};

TEST_F(PlanGateTest, ReportsTheAgeOfAcceptedPlans) {
  EXPECT_EQ(report(0.0).plan_age_s, kNever);
  EXPECT_EQ(report(0.0).planner_age_s, kNever);
  EXPECT_EQ(gate.round(), -1);
  for (const double at_s : {1.0, 2.0}) {
    const models::RobotPlan plan = news(at_s + 0.1);
    EXPECT_EQ(judge(plan, at_s), PlanVerdict::kAccepted);
    EXPECT_EQ(gate.round(), plan.round);
    EXPECT_EQ(held.start_time, plan.trajectory.start_time);
    EXPECT_DOUBLE_EQ(report(at_s + 0.7).plan_age_s, 0.7);
    EXPECT_DOUBLE_EQ(report(at_s + 0.7).planner_age_s, 0.7);
  }
}

// Only consecutive late plans count; a plan in time resets the count.
TEST_F(PlanGateTest, CountsConsecutiveLatePlans) {
  int expected[] = {1, 2, 0, 1, 2, 3, 0, 0, 1};
  bool is_late[] = {true, true, false, true, true, true, false, false, true};
  for (std::size_t i = 0; i < std::size(is_late); ++i) {
    models::RobotPlan plan = news(0.1 * static_cast<double>(i));
    plan.late = is_late[i];
    EXPECT_EQ(judge(plan, 0.1 * static_cast<double>(i)), PlanVerdict::kAccepted);
    EXPECT_EQ(report(1.0).plans_late, expected[i]) << i;
  }
  models::RobotPlan other = news(1.0, 2);
  other.late = true;
  EXPECT_EQ(judge(other, 1.0), PlanVerdict::kNoLease);
  EXPECT_EQ(report(1.0).plans_late, 1) << "late plans of another planner do not count";
}

TEST_F(PlanGateTest, CountsConsecutiveRefusals) {
  const auto refused = [&](double at_s) {
    models::RobotPlan plan = news(at_s);
    plan.trajectory.start.x_m += 1.0;
    return judge(plan, at_s);
  };
  for (const double at_s : {0.0, 1.0}) {
    EXPECT_EQ(judge(news(at_s), at_s), PlanVerdict::kAccepted);
    EXPECT_EQ(report(at_s).plans_refused, 0);
    EXPECT_EQ(refused(at_s + 0.1), PlanVerdict::kDiscontinuous);
    EXPECT_EQ(report(at_s).plans_refused, 1);
    EXPECT_EQ(refused(at_s + 0.2), PlanVerdict::kDiscontinuous);
    EXPECT_EQ(report(at_s).plans_refused, 2);
    models::RobotPlan of_another = news(at_s + 0.3);
    of_another.robot = "Q2";
    EXPECT_EQ(judge(of_another, at_s + 0.3), PlanVerdict::kWrongVehicle);
    EXPECT_EQ(judge(news(at_s + 0.3, 2), at_s + 0.3), PlanVerdict::kNoLease);
    may_take = false;
    EXPECT_EQ(judge(news(at_s + 0.4), at_s + 0.4), PlanVerdict::kNotFollowing);
    may_take = true;
    EXPECT_EQ(report(at_s).plans_refused, 2) << "plans of other planners are not counted";
  }
}

TEST_F(PlanGateTest, AcceptsEachPlanOnceInOrderOfStart) {
  for (const double at_s : {0.0, 1.0}) {
    const models::RobotPlan first = news(at_s + 0.2);
    EXPECT_EQ(judge(first, at_s), PlanVerdict::kAccepted);
    EXPECT_EQ(judge(first, at_s), PlanVerdict::kStale) << "repeated";
    models::RobotPlan before = news(at_s + 0.3);
    before.stamp.sequence = first.stamp.sequence - 1;
    EXPECT_EQ(judge(before, at_s), PlanVerdict::kStale) << "overtaken";
    EXPECT_EQ(judge(news(at_s + 0.2 - 1e-6), at_s), PlanVerdict::kStale) << "begins earlier";
    EXPECT_EQ(judge(news(at_s + 0.2), at_s), PlanVerdict::kAccepted) << "the same start, but newer";
  }
}

TEST_F(PlanGateTest, AcceptsANewPlannerAfterTheLease) {
  sequence = 1000;
  EXPECT_EQ(judge(news(0.0, 1), 0.0), PlanVerdict::kAccepted);
  for (std::int64_t run = 2; run <= 3; ++run) {
    const double heard_s = (limits.planner_lease_s + 0.1) * static_cast<double>(run - 2);
    sequence = 0;
    EXPECT_EQ(judge(news(heard_s + 1.0, run), heard_s + 1.0), PlanVerdict::kNoLease);
    EXPECT_TRUE(report(heard_s + 1.0).second_planner);
    const double taken_s = heard_s + limits.planner_lease_s + 0.1;
    EXPECT_EQ(judge(news(taken_s, run), taken_s), PlanVerdict::kAccepted);
  }
  EXPECT_EQ(gate.lease().takeovers(), 2);
}

// A clock that was never set may give times before 1970.
TEST_F(PlanGateTest, AcceptsAFirstPlanOnAnyClock) {
  constexpr double kEpochS = -1'700'000'000.0;
  for (const double at_s : {kEpochS - 5.0, kEpochS + 5.0, 0.0}) {
    EXPECT_TRUE(accepts_at_first(news(at_s), at_s)) << at_s;
    EXPECT_EQ(judge(news(at_s - 1e-3), at_s), PlanVerdict::kStale) << "begins before the last plan";
  }
}

TEST_F(PlanGateTest, RefusesStaleAndFuturePlans) {
  const double past_s = test::last_accepted(
      0.0, 60.0, 1e-7, [&](double ago_s) { return accepts_at_first(news(-ago_s), 0.0); });
  EXPECT_NEAR(past_s, limits.plan_past_max_s, 2e-6);
  const double ahead_s = test::last_accepted(
      0.0, 60.0, 1e-7, [&](double in_s) { return accepts_at_first(news(in_s), 0.0); });
  EXPECT_NEAR(ahead_s, limits.plan_future_max_s, 2e-6);
  EXPECT_EQ(judge(news(-1.0), 0.0), PlanVerdict::kStale);
  EXPECT_EQ(judge(news(6.0), 0.0), PlanVerdict::kTooFarAhead);
}

// The gate knows only the path to the second plan, which has not begun, so it cannot check a third
// plan.
TEST_F(PlanGateTest, RefusesAPlanAfterOneThatHasNotBegun) {
  for (const double at_s : {0.0, 10.0}) {
    const models::RobotPlan next = news(at_s + 0.5);
    ASSERT_EQ(judge(next, at_s), PlanVerdict::kAccepted);
    course.follow(held, after(at_s));
    EXPECT_EQ(judge(news(at_s + 1.5), at_s + 0.1), PlanVerdict::kTooFarAhead);
    EXPECT_EQ(judge(news(at_s + 0.500001), at_s + 0.1), PlanVerdict::kTooFarAhead);
    EXPECT_EQ(judge(news(at_s + 0.5), at_s + 0.2), PlanVerdict::kAccepted)
        << "replaces the pending plan";
    EXPECT_EQ(judge(news(at_s + 1.5), at_s + 0.5), PlanVerdict::kAccepted)
        << "the pending plan has begun";
    course.hover({1.0, -1.0, 1.0}, kYawRad, after(at_s + 0.6));
    EXPECT_EQ(judge(news(at_s + 2.5), at_s + 0.7), PlanVerdict::kAccepted) << "no plan is pending";
  }
}

TEST_F(PlanGateTest, AcceptsPlansExactlyAtTheTimeLimits) {
  const double past_s = -limits.plan_past_max_s;
  const double future_s = limits.plan_future_max_s;
  for (const auto& [start_s, verdict] : {std::pair(past_s - 1e-6, PlanVerdict::kStale),
                                         {past_s, PlanVerdict::kAccepted},
                                         {future_s, PlanVerdict::kAccepted},
                                         {future_s + 1e-6, PlanVerdict::kTooFarAhead}}) {
    gate = PlanGate("Q1");
    EXPECT_EQ(judge(news(start_s), 0.0), verdict) << start_s;
  }
}

TEST_F(PlanGateTest, AcceptsPlansThatBeginNearTheCourse) {
  for (const double side : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      const double off_m = test::last_accepted(0.0, 0.9, 1e-9, [&](double m) {
        models::RobotPlan plan = news(0.0);
        models::Trajectory& way = plan.trajectory;
        (axis == 0 ? way.start.x_m : axis == 1 ? way.start.y_m : way.height_m) += side * m;
        return accepts_at_first(plan, 0.0);
      });
      EXPECT_NEAR(off_m, limits.plan_start_tolerance_m, 1e-8) << side << " axis " << axis;
    }
    const double turn_rad = test::last_accepted(0.0, 2.0, 1e-9, [&](double rad) {
      models::RobotPlan plan = news(0.0);
      plan.trajectory.start.yaw_rad = wrap_to_pi(kYawRad + side * rad);
      return accepts_at_first(plan, 0.0);
    });
    EXPECT_NEAR(turn_rad, limits.plan_start_turn_rad, 1e-8) << side;
  }
  // The height is a separate argument, because the course does not contain it.
  height_m = 1.0 + limits.plan_start_tolerance_m + 1e-6;
  EXPECT_FALSE(accepts_at_first(news(0.0), 0.0));
}

// A plan that has begun is compared with the course at the current time, a future plan at its start
// time.
TEST_F(PlanGateTest, ComparesThePoseWithThePlanNowOrAtItsStart) {
  HeldPlan drives;
  drives.start_time = kStart;
  drives.start = {1.0, -1.0, kPi};
  drives.height_m = 1.0;
  drives.count = 1;
  drives.segments[0] = {{1.0, 0.0}, 3.0, 0.0};
  course.follow(drives, kStart);
  models::RobotPlan plan = news(0.0);
  plan.trajectory.start.yaw_rad = kPi;
  plan.trajectory.segments = {{{1.0, 0.0}, 1.0, 0.0}, {{}, 0.1, 0.0}};
  plan.trajectory.start_time = after(0.6);
  plan.trajectory.start.x_m = 1.0 - 0.6;
  EXPECT_TRUE(accepts_at_first(plan, 0.0)) << "the course has reached the plan by then";
  EXPECT_TRUE(accepts_at_first(plan, 0.9)) << "plan and course have both advanced";
  plan.trajectory.start.x_m = 1.0;
  EXPECT_FALSE(accepts_at_first(plan, 0.0));
}

// A plan that agrees with the flown path is accepted up to the maximum age. The same path that
// begins now at the old start position is refused.
TEST_F(PlanGateTest, AcceptsPlansThatMatchTheFlownPath) {
  limits.plan_start_tolerance_m = 0.01;
  models::RobotPlan plan = news(0.0);
  plan.trajectory.segments = {{{1.0, -1.0}, 1.0, 0.0}, {{}, 0.1, 0.0}};
  HeldPlan flown;
  ASSERT_TRUE(hold_plan(plan.trajectory, flown));
  course.follow(flown, kStart);
  for (double at_s = 0.0; at_s <= limits.plan_past_max_s; at_s += 0.05) {
    EXPECT_TRUE(accepts_at_first(plan, at_s)) << at_s;
    if (at_s > 0.02) {
      models::RobotPlan begins_again = news(at_s);
      begins_again.trajectory.segments = plan.trajectory.segments;
      EXPECT_FALSE(accepts_at_first(begins_again, at_s)) << at_s;
    }
  }
}

TEST_F(PlanGateTest, RefusesPlansTooCloseToTeammates) {
  limits.plan_separation_m = kSeparationM;
  others = {{nullptr, {1.0, -1.0 + kSeparationM + 0.01, 1.0}}};
  EXPECT_EQ(judge(news(0.0), 0.0), PlanVerdict::kAccepted);
  others[0].position_world_m.y() -= 0.02;
  EXPECT_EQ(judge(news(0.1), 0.1), PlanVerdict::kTeammate);
}

TEST_F(PlanGateTest, CountsEachVerdictByName) {
  const auto bad = [&](auto&& corrupt) {
    models::RobotPlan plan = news(0.1);
    corrupt(plan);
    return plan;
  };
  for (int time = 1; time <= 2; ++time) {
    EXPECT_EQ(judge(news(0.1), 0.0), PlanVerdict::kAccepted);
    EXPECT_EQ(judge(bad([](auto& p) { p.robot = "Q2"; }), 0.0), PlanVerdict::kWrongVehicle);
    EXPECT_EQ(judge(bad([](auto& p) { p.stamp.sequence = 0; }), 0.0), PlanVerdict::kStale);
    EXPECT_EQ(judge(news(9.0), 0.0), PlanVerdict::kTooFarAhead);
    EXPECT_EQ(judge(bad([](auto& p) { p.trajectory.segments.resize(100); }), 0.0),
              PlanVerdict::kNotFinite);
    EXPECT_EQ(judge(bad([](auto& p) {
                      p.trajectory.segments = {{{9.0, 0.0}, 1.0, 0.0}};
                    }),
                    0.0),
              PlanVerdict::kInfeasible);
    EXPECT_EQ(judge(bad([](auto& p) {
                      p.trajectory.segments = {{{1.0, 0.0}, 1.0, 0.0}};
                    }),
                    0.0),
              PlanVerdict::kNoHover);
    EXPECT_EQ(judge(news(0.1, 2), 0.0), PlanVerdict::kNoLease);
    may_take = false;
    EXPECT_EQ(judge(news(0.1), 0.0), PlanVerdict::kNotFollowing);
    may_take = true;
    EXPECT_EQ(judge(bad([](auto& p) { p.trajectory.start.y_m += 0.6; }), 0.0),
              PlanVerdict::kDiscontinuous);
    const auto leads_to = [&](double x_m, double y_m) {
      const double distance_m = std::hypot(x_m - 1.0, y_m + 1.0);
      return bad([&](auto& p) {
        p.trajectory.segments = {
            {{0.0, 3.0}, 0.0, 0.0}, {{1.0, 0.0}, distance_m, 0.0}, {{}, 0.1, 0.0}};
      });
    };
    EXPECT_EQ(judge(leads_to(-4.0, -1.0), 0.0), PlanVerdict::kOutsideFence);
    const models::World room = limits.fence;
    limits.fence.obstacles.push_back({{{-0.5, -1.2}, {-0.3, -0.8}}, 2.0});
    EXPECT_EQ(judge(leads_to(-1.0, -1.0), 0.0), PlanVerdict::kObstacle);
    limits.fence = room;
    others = {{nullptr, {1.0, -0.9, 1.0}}};
    EXPECT_EQ(judge(news(0.1), 0.0), PlanVerdict::kTeammate);
    others[0].position_world_m.y() = -1.0 + limits.plan_separation_m + 5e-4;
    EXPECT_EQ(judge(bad([](auto& p) {
                      p.trajectory.segments = {{{0.0, 3.0}, 59.0, 0.0}};
                    }),
                    0.0),
              PlanVerdict::kTooCostly);
    others.clear();
    std::vector<models::NamedCount> counts;
    gate.count(counts);
    EXPECT_EQ(counts.size(), kPlanVerdicts - 1);
    for (const models::NamedCount& count : counts) {
      EXPECT_EQ(count.count, time) << count.name;
    }
  }
}

// Each verdict has its own counter.
TEST_F(PlanGateTest, CountsEachVerdictSeparately) {
  const std::map<std::string, int> met = {
      {"accepted", 5}, {"wrong vehicle", 1}, {"stale", 2}, {"too far ahead", 3}, {"not finite", 4}};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(judge(news(0.0), 0.0), PlanVerdict::kAccepted);
  }
  models::RobotPlan of_another = news(0.0);
  of_another.robot = "Q2";
  EXPECT_EQ(judge(of_another, 0.0), PlanVerdict::kWrongVehicle);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(judge(news(-9.0), 0.0), PlanVerdict::kStale);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(judge(news(9.0), 0.0), PlanVerdict::kTooFarAhead);
  }
  for (int i = 0; i < 4; ++i) {
    models::RobotPlan plan = news(0.0);
    plan.trajectory.segments.resize(HeldPlan::kSegmentsMax + 1);
    EXPECT_EQ(judge(plan, 0.0), PlanVerdict::kNotFinite);
  }
  std::vector<models::NamedCount> counts;
  gate.count(counts);
  EXPECT_EQ(counts.size(), kPlanVerdicts - 1) << "one counter per refusal";
  for (const models::NamedCount& count : counts) {
    const auto found = met.find(count.name.substr(std::string("plan.").size()));
    EXPECT_EQ(count.count, found == met.end() ? 0 : found->second) << count.name;
  }
}

// Each time, a second planner is reported until it has been silent for the lease time.
TEST_F(PlanGateTest, ReportsASecondPlannerForTheLeaseTime) {
  EXPECT_EQ(judge(news(0.0, 1), 0.0), PlanVerdict::kAccepted);
  EXPECT_FALSE(report(0.0).second_planner);
  for (const double at_s : {1.0, 9.0}) {
    EXPECT_EQ(judge(news(at_s, 1), at_s - 0.1), PlanVerdict::kAccepted);
    EXPECT_EQ(judge(news(at_s, 2), at_s), PlanVerdict::kNoLease);
    const double until_s = test::last_accepted(
        at_s, at_s + 7.0, 1e-7, [&](double t_s) { return report(t_s).second_planner; });
    EXPECT_NEAR(until_s, at_s + limits.planner_lease_s, 2e-6);
  }
}

TEST_F(PlanGateTest, AllocatesNothing) {
  models::RobotPlan plan = news(0.0);
  plan.trajectory.segments = {{{0.5, 0.0}, 0.5, 0.0}, {{}, 0.1, 0.0}};
  const test::AllocationCounter allocations;
  const PlanVerdict verdict = judge(plan, 0.0);
  EXPECT_EQ(allocations.count(), 0u);
  EXPECT_EQ(verdict, PlanVerdict::kAccepted);
}

}  // namespace
}  // namespace vantage::drivers
