#include <algorithm>
#include <string>
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

}  // namespace
}  // namespace vantage::test
