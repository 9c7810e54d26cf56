#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/pose_monitor.hpp"
#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

// Without a fault nothing acts: the laws below are worth nothing if everything always holds.
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

// Whatever can be refused has a counter, under a name of its own.
TEST(FlightGuard, CountsEveryVerdictByItsName) {
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

// What another source of mocap shows is not used, however near it is; what the own one shows is.
TEST(FlightGuard, BelievesNoFrameOfASecondSource) {
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

// Each counter counts what its name says.
TEST(FlightGuard, CountsEachVerdictOfAPoseUnderItsName) {
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
