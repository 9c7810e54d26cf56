#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/course.hpp"
#include "drivers/safety/limits.hpp"
#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/pose_monitor.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

// Flight safety does not intervene in a flight without faults. The fault tests rely on this.
TEST(FlightGuard, FollowsForAMinuteWithoutAReasonToStop) {
  FlightBench bench(1);
  bench.fly_up(5.0);
  int ticks_away = 0;
  for (int i = 0; i < 6000; ++i) {
    bench.tick();
    for (const Vehicle& vehicle : bench.vehicles()) {
      if (vehicle.out.state != FlightState::kFollow && ticks_away++ < 5) {
        const auto rows = drivers::conditions();
        for (std::size_t r = 0; r < rows.size(); ++r) {
          if (vehicle.out.reasons[r]) {
            ADD_FAILURE() << vehicle.name << " at " << bench.time_s() << ": " << rows[r].name;
          }
        }
      }
    }
  }
  EXPECT_EQ(ticks_away, 0);
  EXPECT_TRUE(bench.violations().empty()) << bench.violations().front();
  EXPECT_GT(bench.closest_m(), 1.0);
  for (const Vehicle& vehicle : bench.vehicles()) {
    EXPECT_GT(vehicle.round, 60);
  }
}

// Set-points follow the course of the plans. A plan applies beyond its round only after the next
// one has arrived. The course is not slowed while poses are younger than 50 ms.
TEST(FlightGuard, FollowsThePlanUntilTheRoundEnds) {
  FlightBench bench(1);
  bench.fly_up(5.0);
  Vehicle& q1 = bench.vehicle("Q1");
  const drivers::SafetyLimits limits = drivers::limits_for(FlightBench::scenario(), "Q1");
  ASSERT_EQ(limits.round_s, 1.0);
  drivers::Course course(drivers::half_window_s(limits.vehicle), 1.0);
  drivers::Course endless(drivers::half_window_s(limits.vehicle));
  int different = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t plans = q1.sent.size();
    const Time now = bench.now();
    if (i / 100 % 5 == 1) {  // makes plans end at any time within a round
      q1.knobs.plan = PlanFault::kDropped;
    }
    bench.room().mocap_age_ms = 8;
    bench.tick();
    ASSERT_EQ(q1.out.state, FlightState::kFollow) << i;
    drivers::HeldPlan plan;
    if (q1.sent.size() > plans && drivers::hold_plan(q1.sent.back().trajectory, plan)) {
      course.follow(plan, now);
      endless.follow(plan, now);
    }
    course.advance(now, FlightBench::kTickS, 1.0);
    endless.advance(now, FlightBench::kTickS, 1.0);
    if (i < 300) {
      continue;  // the course does not contain the previous plan yet
    }
    const Time soon = now + from_seconds(limits.setpoint_lead_s);
    const Eigen::Vector3d asked_m = q1.out.setpoint.position_world_m;
    EXPECT_LT((asked_m - course.at(soon).position_world_m).head<2>().norm(), 1e-9) << i;
    different += (asked_m - endless.at(soon).position_world_m).head<2>().norm() > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(different, 10) << "no plan turned or braked just after a round";
}

// Every possible refusal has its own counter.
TEST(FlightGuard, CountsEveryPlanVerdictByName) {
  FlightBench bench(1);
  std::vector<std::string> names;
  for (const models::NamedCount& each : bench.vehicle("Q1").guard->counters()) {
    names.push_back(each.name);
  }
  for (std::size_t i = 1; i < drivers::kPoseVerdicts; ++i) {
    const std::string name = name_of(static_cast<drivers::PoseVerdict>(i));
    EXPECT_EQ(std::count(names.begin(), names.end(), "pose." + name), 1) << name;
  }
  for (std::size_t i = 1; i < drivers::kPlanVerdicts; ++i) {
    const std::string name = name_of(static_cast<drivers::PlanVerdict>(i));
    EXPECT_EQ(std::count(names.begin(), names.end(), "plan." + name), 1) << name;
  }
}

// Frames of a second source are ignored, even if they are similar to those of the accepted source.
TEST(FlightGuard, IgnoresFramesOfASecondSource) {
  FlightBench bench(2);
  bench.run(1.0);
  Vehicle& q1 = bench.vehicle("Q1");
  for (int i = 0; i < 5; ++i) {
    const Pose3 before = q1.guard->world_from_body();
    models::MocapFrame other;
    other.stamp = {bench.now(), 99, i};
    other.frame_number = i;
    other.arrival = bench.now();
    other.bodies = {{"Q1", before, false}};
    other.bodies[0].world_from_body.translation_m.x() += 0.1;
    EXPECT_FALSE(q1.guard->on_mocap(other, bench.now()));
    EXPECT_EQ(q1.guard->world_from_body().translation_m, before.translation_m);
    bench.tick();
    EXPECT_NE(q1.guard->world_from_body().translation_m, before.translation_m);
  }
}

// Each fault increases the counter with its name.
TEST(FlightGuard, CountsEveryPoseVerdictByName) {
  FlightBench bench(2);
  bench.run(1.0);
  Vehicle& q1 = bench.vehicle("Q1");
  const auto count = [&](const std::string& name) {
    for (const models::NamedCount& each : q1.guard->counters()) {
      if (each.name == name) {
        return each.count;
      }
    }
    return std::int64_t{-1};
  };
  const std::pair<BodyFault, const char*> faults[] = {{BodyFault::kOccluded, "pose.absent"},
                                                      {BodyFault::kDuplicated, "pose.duplicate"},
                                                      {BodyFault::kNotANumber, "pose.malformed"},
                                                      {BodyFault::kMillimetres, "pose.outside"}};
  for (const auto& [fault, name] : faults) {
    std::map<std::string, std::int64_t> before;
    for (const auto& each : faults) {
      before[each.second] = count(each.second);
    }
    bench.run(0.1, [&, is = fault] { q1.knobs.body = {is}; });
    bench.run(0.1);
    for (const auto& each : faults) {
      EXPECT_EQ(count(each.second) - before[each.second], each.second == name ? 10 : 0)
          << each.second << " while " << name;
    }
  }
}

}  // namespace
}  // namespace vantage::test
