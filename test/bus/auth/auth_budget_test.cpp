#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "bus/auth/envelope.hpp"
#include "test/bus/auth/auth_support.hpp"

// Limits of the replay memory and of the signature-check budgets.

namespace vantage::bus::auth {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

constexpr Time kNow = Time{Duration{1'700'000'000'000'000}};
constexpr std::uint64_t kNowCounter = 1'700'000'000'000'000;

TEST(Budget, RefillsAtItsRateUpToItsBurst) {
  Budget budget(2.0, 3.0);
  const auto spend = [&budget](Time now) {
    int out = 0;
    while (out < 100 && budget.take(now)) {
      ++out;
    }
    return out;
  };
  EXPECT_EQ(spend(kNow), 3);
  EXPECT_EQ(spend(kNow + milliseconds(499)), 0) << "less than one unit has been refilled";
  EXPECT_EQ(spend(kNow + milliseconds(500)), 1);
  EXPECT_EQ(spend(kNow + milliseconds(1'500)), 2);
  EXPECT_EQ(spend(kNow + hours(1)), 3) << "no more than the burst";
  EXPECT_EQ(spend(kNow + hours(1)), 0);
}

const Budget kNone(0.0, 0.0);
const Budget kAny(1e9, 1e9);
constexpr std::uint64_t host(std::uint64_t number, std::uint64_t port = 0) {
  return (number << 16U) | port;
}

TEST(SignatureBudgets, HostBudgetCoversAllPorts) {
  SignatureBudgets budgets({kNone, kNone}, {Budget(0.0, 3.0), Budget(0.0, 2.0)}, {kAny, kAny});
  int orders = 0;
  int stops = 0;
  for (std::uint64_t port = 1; port < 10; ++port) {
    orders += budgets.take({host(1, port), port}, false, kNow) ? 1 : 0;
    stops += budgets.take({host(1, 65'535), port}, true, kNow) ? 1 : 0;
  }
  EXPECT_EQ(orders, 3);
  EXPECT_EQ(stops, 2);
  EXPECT_TRUE(budgets.take({host(2, 1), 1}, false, kNow)) << "another host has a separate budget";
}

// A sender with a valid signature is identified by address and session together.
TEST(SignatureBudgets, VerifiedSenderHasASeparateBudget) {
  SignatureBudgets budgets({Budget(0.0, 2.0), Budget(0.0, 2.0)}, {kNone, kNone}, {kAny, kAny});
  const Sender known{host(1, 5), 7};
  EXPECT_FALSE(budgets.take(known, false, kNow));
  budgets.add_verified(known, kNow);
  EXPECT_FALSE(budgets.take({host(1, 6), 7}, false, kNow));
  EXPECT_FALSE(budgets.take({host(1, 5), 8}, false, kNow));
  EXPECT_TRUE(budgets.take(known, false, kNow));
  budgets.add_verified(known, kNow);
  EXPECT_TRUE(budgets.take(known, false, kNow));
  EXPECT_FALSE(budgets.take(known, false, kNow)) << "a valid signature does not refill the budget";
  EXPECT_TRUE(budgets.take(known, true, kNow)) << "stops have a separate budget";
}

TEST(SignatureBudgets, ReplacesTheLongestSilentSenderAfterThreeSeconds) {
  SignatureBudgets budgets({kAny, kAny}, {kNone, kNone}, {kNone, kNone});
  const auto sender = [](int i) { return Sender{host(static_cast<std::uint64_t>(i)), 1}; };
  for (int i = 0; i < 16; ++i) {
    budgets.add_verified(sender(i), kNow + milliseconds(i));
  }
  budgets.add_verified(sender(0), kNow + milliseconds(20));
  const Time later = kNow + milliseconds(1) + SignatureBudgets::kKeptFor;
  budgets.add_verified(sender(16), later);
  EXPECT_FALSE(budgets.take(sender(16), false, later)) << "each sender was received within 3 s";
  EXPECT_TRUE(budgets.take(sender(1), false, later));
  budgets.add_verified(sender(16), later + Duration{1});
  EXPECT_FALSE(budgets.take(sender(1), false, later + milliseconds(1)));
  for (const int i : {0, 2, 15, 16}) {
    EXPECT_TRUE(budgets.take(sender(i), false, later + milliseconds(1))) << i;
  }
}

TEST(SignatureBudgets, ReplacesTheLongestSilentHostAfterThreeSeconds) {
  SignatureBudgets budgets({kNone, kNone}, {Budget(0.0, 1.0), Budget(0.0, 1.0)}, {kAny, kAny});
  const auto take = [&budgets](std::uint64_t number, int at_ms) {
    return budgets.take({host(number), 1}, false, kNow + milliseconds(at_ms));
  };
  for (std::uint64_t i = 0; i < 64; ++i) {
    EXPECT_TRUE(take(i, static_cast<int>(i)));
  }
  EXPECT_FALSE(take(0, 70)) << "all hosts are remembered";
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(take(64, 3'001)) << "the host is not remembered and uses the common budget";
  }
  EXPECT_TRUE(take(64, 3'002));
  EXPECT_FALSE(take(64, 3'003)) << "the host has replaced host 1";
  EXPECT_FALSE(take(0, 3'003));
  EXPECT_FALSE(take(2, 3'003));
}

TEST(SignatureBudgets, UnknownSendersOfAllHostsShareOneBudget) {
  SignatureBudgets budgets({kNone, kNone}, {kAny, kAny}, {Budget(0.0, 3.0), Budget(0.0, 5.0)});
  int orders = 0;
  int stops = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    orders += budgets.take({host(i), i}, false, kNow) ? 1 : 0;
    stops += budgets.take({host(i), i}, true, kNow) ? 1 : 0;
  }
  EXPECT_EQ(orders, 3);
  EXPECT_EQ(stops, 5);
}

// Compares the guard with a set of all received counters. The guard stores the newest 64 counters.
// Once it has dropped a counter, it refuses this and all lower counters.
TEST(ReplayGuard, AgreesWithAReferenceThatStoresAllCounters) {
  std::mt19937_64 rng(9);
  for (int trial = 0; trial < 30; ++trial) {
    ReplayGuard guard;
    std::set<std::uint64_t> accepted_counters;
    std::uint64_t forgotten = 0;
    std::uint64_t newest = 200;
    for (int i = 0; i < 2'000; ++i) {
      const std::uint64_t counter =
          newest + rng() % 5 - std::min<std::uint64_t>(rng() % 130, newest);
      const bool is_new = counter > forgotten && !accepted_counters.contains(counter);
      ASSERT_EQ(guard.refuses(1, 1, counter), !is_new);
      ASSERT_EQ(guard.refuses(1, 1, counter), !is_new) << "a query changes nothing";
      ASSERT_EQ(guard.admit(1, 1, counter), is_new);
      if (is_new) {
        accepted_counters.insert(counter);
        if (accepted_counters.size() > 64) {
          forgotten = *accepted_counters.begin();
          accepted_counters.erase(accepted_counters.begin());
        }
      }
      newest = std::max(newest, counter);
    }
    EXPECT_FALSE(guard.refuses(1, 2, 1)) << "another session";
    EXPECT_FALSE(guard.refuses(2, 1, 1)) << "another key";
    EXPECT_FALSE(guard.knows(2, 1));
    EXPECT_TRUE(guard.knows(1, 1));
  }
}

TEST(Verify, AcceptsMessagesWithinTwoSecondsOfNow) {
  const Key key = test::key_of(Role::kMocap, 1);
  const Key station = test::key_of(Role::kOperator, 4);
  struct Row {
    std::int64_t off_us;
    bool is_current;
  };
  for (const Row& row : {Row{-2'000'001, false}, Row{-2'000'000, true}, Row{0, true},
                         Row{2'000'000, true}, Row{2'000'001, false}}) {
    Keyring keyring;
    keyring.add(test::key_of(Role::kMocap, 1));
    keyring.add(test::key_of(Role::kOperator, 4));
    ReplayGuard replays;
    SignatureBudgets budgets;
    const std::uint64_t counter = kNowCounter + static_cast<std::uint64_t>(row.off_us);
    const auto judged = [&](const Key& signer, const char* channel) {
      std::vector<std::uint8_t> message{1, 2, 3};
      sign(signer, channel, {0, 5, counter, signer.role, scenario::TrialMode::kLive}, {}, message);
      return verify(keyring, channel, message, {scenario::TrialMode::kLive, kNow}, replays, budgets)
          .refusal;
    };
    EXPECT_EQ(judged(key, "VICON"), row.is_current ? Refusal::kNone : Refusal::kStale)
        << row.off_us;
    EXPECT_EQ(judged(station, "COMMAND"), Refusal::kNone) << "the clock of a station may be wrong";
  }
}

}  // namespace
}  // namespace vantage::bus::auth
