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

TEST(RoundSchedule, FindsTheNextSlot) {
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
  spec.team_budget_s = 0.4;
  EXPECT_NO_THROW(RoundSchedule(spec, 0, 1)) << "the complete round";
  EXPECT_EQ(to_utime(RoundSchedule(spec, 0, 1).slot(4).begin), 2'000'000);
  spec.team_budget_s = 0.4 + 1e-6;
  EXPECT_THROW(RoundSchedule(spec, 0, 1), UsageError);
}

TEST(RoundSchedule, RefusesAnUnknownRobot) {
  const scenario::PlannerSpec spec;
  EXPECT_NO_THROW(RoundSchedule(spec, 0, 1));
  EXPECT_NO_THROW(RoundSchedule(spec, 2, 3));
  EXPECT_THROW(RoundSchedule(spec, 3, 3), UsageError);
  EXPECT_THROW(RoundSchedule(spec, -1, 3), UsageError);
  EXPECT_THROW(RoundSchedule(spec, 0, 0), UsageError);
  scenario::PlannerSpec still;
  still.execute_steps = 0;
  still.team_budget_s = still.publish_margin_s = 0.0;
  EXPECT_THROW(RoundSchedule(still, 0, 1), UsageError);
}

// Round 9 of 1.5 s begins at 13.5 s and ends at 15 s. The budget of 0.6 s ends 0.1 s before that.
// It contains three slots, or three proposal slots in its first half and three slots in its second
// half.
TEST(RoundSchedule, PlacesSlotsBeforeTheEndOfTheRound) {
  scenario::PlannerSpec spec;
  spec.step_s = 0.5;
  spec.execute_steps = 3;
  spec.team_budget_s = 0.6;
  spec.publish_margin_s = 0.1;
  for (int i = 0; i < 3; ++i) {
    spec.attacks_max = 0;
    const RoundSchedule plain(spec, i, 3);
    EXPECT_EQ(plain.round_length(), from_seconds(1.5));
    EXPECT_FALSE(plain.is_shared());
    EXPECT_EQ(plain.slots(), 3);
    EXPECT_EQ(plain.first_slot_index(), i);
    const auto slot = plain.slot(9);
    EXPECT_EQ(slot.round, 9);
    EXPECT_EQ(slot.slot_index, i);
    EXPECT_FALSE(slot.is_proposal);
    EXPECT_EQ(to_utime(slot.begin), 14'300'000 + 200'000 * i);
    EXPECT_EQ(to_utime(slot.end), 14'500'000 + 200'000 * i);
    EXPECT_EQ(to_utime(slot.activation), 15'000'000);
    for (int slot_index = 0; slot_index < 3; ++slot_index) {
      EXPECT_EQ(to_utime(plain.slot(9, slot_index).begin), 14'300'000 + 200'000 * slot_index);
      EXPECT_EQ(plain.slot(9, slot_index).slot_index, slot_index);
    }
    spec.attacks_max = 1;
    const RoundSchedule wary(spec, i, 3);
    const auto proposal = wary.proposal_slot(9);
    EXPECT_TRUE(proposal.is_proposal);
    EXPECT_EQ(proposal.round, 9);
    EXPECT_EQ(to_utime(proposal.begin), 14'300'000 + 100'000 * i);
    EXPECT_EQ(to_utime(proposal.end), 14'400'000 + 100'000 * i);
    EXPECT_EQ(to_utime(proposal.activation), 15'000'000);
    EXPECT_EQ(to_utime(wary.slot(9).begin), 14'600'000 + 100'000 * i);
    EXPECT_EQ(to_utime(wary.slot(9).end), 14'700'000 + 100'000 * i);
    spec.team_algorithm = scenario::TeamAlgorithm::kLocalSearch;
    const auto exchange = RoundSchedule(spec, i, 3).proposal_slot(9);
    EXPECT_EQ(to_utime(exchange.begin), 14'300'000) << "common to all robots";
    EXPECT_EQ(to_utime(exchange.end), 14'600'000);
    spec.team_algorithm = scenario::TeamAlgorithm::kCoordinateDescent;
  }
}

// Compares the result with a search over all slots and proposal slots around the time.
TEST(RoundSchedule, FindsTheNextSlotAndProposalSlot) {
  std::mt19937_64 rng(4);
  for (const int attacks_max : {0, 1}) {
    scenario::PlannerSpec spec;
    spec.attacks_max = attacks_max;
    spec.execute_steps = 2;
    const RoundSchedule schedule(spec, 2, 3);
    for (int i = 0; i < 500; ++i) {
      const Time now = from_utime(1'700'000'000'000'000 +
                                  std::uniform_int_distribution<std::int64_t>(0, 9'000'000)(rng));
      std::optional<RoundSchedule::Slot> first;
      const std::int64_t around = now.time_since_epoch() / schedule.round_length();
      for (std::int64_t round = around - 2; round <= around + 2; ++round) {
        for (const bool is_proposal : {true, false}) {
          if (is_proposal && attacks_max == 0) {
            continue;
          }
          const auto slot = is_proposal ? schedule.proposal_slot(round) : schedule.slot(round);
          if (slot.begin > now && (!first || slot.begin < first->begin)) {
            first = slot;
          }
        }
      }
      const auto next = schedule.next_slot(now);
      EXPECT_EQ(next.begin, first->begin);
      EXPECT_EQ(next.round, first->round);
      EXPECT_EQ(next.is_proposal, first->is_proposal);
      const int slot_index = i % 3;
      const auto after = schedule.slot_after(around - 3, now, slot_index);
      EXPECT_GT(after.begin, now);
      EXPECT_LE(schedule.slot(after.round - 1, slot_index).begin, now);
      EXPECT_EQ(after.slot_index, slot_index);
      EXPECT_EQ(schedule.slot_after(around + 5, now, slot_index).round, around + 6);
    }
    const auto slot = schedule.slot(1'700'000'000);
    EXPECT_EQ(schedule.next_slot(slot.begin - Duration{1}).begin, slot.begin);
    EXPECT_GT(schedule.next_slot(slot.begin).begin, slot.begin);
    EXPECT_EQ(schedule.slot_after(5, slot.begin - Duration{1}, 2).begin, slot.begin);
    EXPECT_EQ(schedule.slot_after(5, slot.begin, 2).round, slot.round + 1);
  }
}

// Slots begin at whole microseconds for any budget. Only the exact begin time identifies a slot.
TEST(RoundSchedule, FindsTheSlotOfAPlan) {
  scenario::PlannerSpec spec;
  spec.execute_steps = 2;
  for (const double budget_s : {0.5, 0.499999, 0.1, 5e-6}) {
    spec.team_budget_s = budget_s;
    for (const int attacks_max : {0, 2}) {
      spec.attacks_max = attacks_max;
      for (const int robots : {1, 2, 7, 48}) {
        const RoundSchedule schedule(spec, 0, robots);
        const bool are_apart = budget_s > 1e-3;
        for (int slot_index = 0; slot_index < robots; ++slot_index) {
          models::RobotPlan plan;
          plan.round = 77;
          plan.slot_start = schedule.slot(77, slot_index).begin;
          const auto found = schedule.slot_index_of(plan);
          if (are_apart) {
            EXPECT_EQ(found, slot_index) << budget_s << ' ' << robots;
          }
          for (const int us : {-1, 1}) {
            plan.slot_start = schedule.slot(77, slot_index).begin + Duration{us};
            EXPECT_FALSE(are_apart && schedule.slot_index_of(plan)) << budget_s << ' ' << robots;
          }
          plan.slot_start = schedule.slot(77, slot_index).begin;
          ++plan.round;
          EXPECT_EQ(schedule.slot_index_of(plan), std::nullopt) << "a previous round";
        }
        models::RobotPlan plan;
        plan.round = 77;
        plan.slot_start = schedule.slot(77, robots - 1).end;
        EXPECT_EQ(schedule.slot_index_of(plan), std::nullopt) << "after the last slot";
      }
    }
  }
}

}  // namespace
}  // namespace vantage::planner
