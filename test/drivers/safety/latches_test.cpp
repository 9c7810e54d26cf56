#include "drivers/safety/latches.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "test/support/random.hpp"

// Tests timing, latching and clearing of conditions with an artificial table, in which a row's
// condition is true while the row's bit is set. The result is compared with a brute-force
// evaluation of the complete history.

namespace vantage::drivers {
namespace {

using models::OperatorAction;

constexpr std::size_t kRows = 20;
constexpr Time kStart{Duration{1'000'000}};

/// True while bit kBit of poses_rejected is set; row i uses bit i.
template <std::size_t kBit>
bool is_set(const SafetyInputs& inputs, const SafetyLimits& /*limits*/) {
  return ((static_cast<unsigned>(inputs.poses_rejected) >> kBit) & 1U) != 0;
}

template <std::size_t... kBits>
std::array<bool (*)(const SafetyInputs&, const SafetyLimits&), kRows> all_bits(
    std::index_sequence<kBits...> /*bits*/) {
  return {is_set<kBits>...};
}

/// Returns rows with every combination of clearing and severity. Some rows need a minimum duration,
/// some yield.
std::vector<Condition> made_rows() {
  const auto bits = all_bits(std::make_index_sequence<kRows>());
  std::vector<Condition> rows;
  for (const Clearing clearing : {Clearing::kAtOnce, Clearing::kSelf, Clearing::kOperator,
                                  Clearing::kGround, Clearing::kRearm}) {
    for (const Severity severity :
         {Severity::kNote, Severity::kHold, Severity::kLand, Severity::kKill}) {
      const std::size_t i = rows.size();
      rows.push_back({"row", severity, clearing, i % 3 == 0, i % 2 == 0 ? 0.0 : 0.3, "", "",
                      bits[i], i % 4 >= 2, i % 5 == 1});
    }
  }
  return rows;
}

TEST(Latches, EqualTheEvaluationOfTheCompleteHistory) {
  const std::vector<Condition> rows = made_rows();
  SafetyLimits limits;
  limits.clear_s = 0.5;
  limits.yield_s = 0.7;
  test::Random random(11);
  LadderState ladder;
  std::array<bool, kRows> latched{};
  std::vector<SafetyInputs> history;
  std::array<int, 5> cleared{};
  for (int tick = 0; tick < 5'000; ++tick) {
    SafetyInputs inputs = history.empty() ? SafetyInputs{} : history.back();
    inputs.now = history.empty() ? kStart : inputs.now + from_seconds(0.1);
    const unsigned flipped = random.integer(0, 3) == 0 ? 1U << random.integer(0, kRows - 1) : 0U;
    inputs.poses_rejected =
        static_cast<int>(static_cast<unsigned>(inputs.poses_rejected) ^ flipped);
    inputs.yields = random.coin();
    inputs.request.reset();
    if (random.integer(0, 9) == 0) {
      inputs.request = random.coin() ? OperatorAction::kFollow : OperatorAction::kArm;
    }
    history.push_back(inputs);

    watch(ladder, rows, inputs, limits);
    latch(ladder, rows, inputs, limits);
    for (std::size_t i = 0; i < kRows; ++i) {
      // Computes the duration of the current uninterrupted period of the condition.
      const bool holds = rows[i].holds(inputs, limits);
      Time since = inputs.now;
      bool held_ever = false;
      for (auto it = history.rbegin(); it != history.rend(); ++it) {
        if (rows[i].holds(*it, limits) != holds) {
          held_ever = true;
          break;
        }
        since = it->now;
      }
      const double for_s = to_seconds(inputs.now - since);
      if (holds && for_s >= rows[i].after_s) {
        latched[i] = true;
      } else if (!holds && latched[i]) {
        ASSERT_TRUE(held_ever);
        const double wait_s = limits.clear_s + (rows[i].yields && inputs.yields ? 0.7 : 0.0);
        const bool is_cleared = rows[i].clearing == Clearing::kAtOnce ||
                                (rows[i].clearing == Clearing::kSelf && for_s >= wait_s) ||
                                (rows[i].clearing == Clearing::kOperator &&
                                 is_requested(inputs, OperatorAction::kFollow));
        cleared[static_cast<std::size_t>(rows[i].clearing)] += is_cleared ? 1 : 0;
        latched[i] = !is_cleared;
      }
      ASSERT_EQ(ladder.latched[i], latched[i]) << "row " << i << " tick " << tick;
      ASSERT_EQ(ladder.held[i], holds);
      if (holds) {
        ASSERT_EQ(ladder.since[i], since);
      } else if (held_ever) {
        ASSERT_EQ(ladder.gone_since[i], since);
      }
    }
  }
  EXPECT_GT(cleared[0], 50);
  EXPECT_GT(cleared[1], 50);
  EXPECT_GT(cleared[2], 50);
  EXPECT_TRUE(ladder.latched[kRows - 1]) << "only arming again clears this condition";
}

/// Expects `ask` to return `expected` for each row alone, and for each row together with all rows
/// for which false is expected.
template <class Ask>
void expect_of_rows(const std::vector<Condition>& rows, const Ask& ask,
                    const std::vector<bool>& expected) {
  for (std::size_t i = 0; i < kRows; ++i) {
    Reasons one;
    one.set(i);
    EXPECT_EQ(ask(one), expected[i]) << i;
    Reasons others;
    for (std::size_t k = 0; k < kRows; ++k) {
      others[k] = !expected[k];
    }
    EXPECT_FALSE(ask(others));
    others.set(i);
    EXPECT_EQ(ask(others), expected[i]) << i;
  }
  EXPECT_FALSE(ask({}));
  EXPECT_EQ(rows.size(), kRows);
}

TEST(Latches, ActBySeverityAndClearing) {
  const std::vector<Condition> rows = made_rows();
  const auto of = [&](auto&& is) {
    std::vector<bool> out;
    std::transform(rows.begin(), rows.end(), std::back_inserter(out), is);
    return out;
  };
  for (const Severity severity :
       {Severity::kNote, Severity::kHold, Severity::kLand, Severity::kKill}) {
    expect_of_rows(
        rows, [&](const Reasons& latched) { return acts(rows, latched, severity); },
        of([&](const Condition& row) { return row.severity == severity; }));
  }
  for (const Clearing clearing : {Clearing::kAtOnce, Clearing::kSelf, Clearing::kOperator,
                                  Clearing::kGround, Clearing::kRearm}) {
    expect_of_rows(
        rows,
        [&](const Reasons& held) {
          LadderState ladder;
          ladder.held = held;
          return holds_any(rows, ladder, clearing);
        },
        of([&](const Condition& row) { return row.clearing == clearing; }));
  }
  // Notes, and conditions that clear at once, do not make a vehicle wait for more than a plan.
  expect_of_rows(
      rows, [&](const Reasons& latched) { return waits_for_more_than_a_plan(rows, latched); },
      of([](const Condition& row) {
        return row.severity != Severity::kNote && row.clearing != Clearing::kAtOnce;
      }));
  expect_of_rows(
      rows, [&](const Reasons& reasons) { return needs_operator(rows, reasons); },
      of([](const Condition& row) {
        return row.clearing == Clearing::kOperator || row.clearing == Clearing::kRearm;
      }));
}

TEST(Latches, ForbidArmingAndTakingOffWhileTheirConditionsAreTrue) {
  const std::vector<Condition> rows = made_rows();
  for (unsigned bits : {0U, 0x5A5A5U, 0xFFFFFU, 1U, 1U << (kRows - 1), 0x12345U}) {
    SafetyInputs inputs;
    inputs.poses_rejected = static_cast<int>(bits);
    const Reasons arming = arming_blocks(rows, inputs, {});
    const Reasons take_off = take_off_blocks(rows, inputs, {});
    for (std::size_t i = 0; i < kRows; ++i) {
      const bool holds = (bits >> i & 1U) != 0;
      EXPECT_EQ(arming[i], holds && i % 3 == 0) << i;
      EXPECT_EQ(take_off[i], holds && i % 5 == 1) << i;
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
