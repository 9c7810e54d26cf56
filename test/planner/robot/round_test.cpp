#include "planner/robot/round.hpp"

#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"

namespace vantage::planner {
namespace {

TEST(RoundSchedule, GivesEachRobotItsOwnSlotBeforeTheRoundEnds) {
  scenario::PlannerSpec spec;
  spec.execute_steps = 2;
  const int robots = 7;
  for (std::int64_t round : {0L, 5L, 1'700'000'000L}) {
    std::optional<Time> last_end;
    for (int i = 0; i < robots; ++i) {
      const auto slot = RoundSchedule(spec, i, robots).slot(round);
      EXPECT_LT(slot.begin, slot.end);
      EXPECT_LE(slot.end, slot.activation - from_seconds(spec.publish_margin_s));
      EXPECT_EQ(to_utime(slot.activation), (round + 1) * 1'000'000);
      if (last_end) {
        EXPECT_EQ(slot.begin, *last_end);
      }
      last_end = slot.end;
    }
  }
}

TEST(RoundSchedule, FindsTheFirstSlotThatIsStillAhead) {
  scenario::PlannerSpec spec;
  const RoundSchedule schedule(spec, 1, 3);
  std::mt19937_64 rng(3);
  std::uniform_int_distribution<std::int64_t> any(0, 40'000'000);
  for (int i = 0; i < 2'000; ++i) {
    const Time now = from_utime(1'700'000'000'000'000 + any(rng));
    const auto slot = schedule.next_slot(now);
    EXPECT_GT(slot.begin, now);
    EXPECT_LE(schedule.slot(slot.round - 1).begin, now);
  }
}

TEST(RoundSchedule, RefusesABudgetThatDoesNotFit) {
  scenario::PlannerSpec spec;
  spec.execute_steps = 1;
  spec.team_budget_s = 0.5;
  spec.publish_margin_s = 0.1;
  EXPECT_THROW(RoundSchedule(spec, 0, 1), UsageError);
}

}  // namespace
}  // namespace vantage::planner
