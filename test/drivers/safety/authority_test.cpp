#include "drivers/safety/authority.hpp"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/inputs.hpp"

namespace vantage::drivers {
namespace {

using models::OperatorAction;
constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kSilentS = 1.0;

models::OperatorCommand command(OperatorAction action, std::int64_t run, std::int64_t sequence,
                                double at_s) {
  models::OperatorCommand out;
  out.stamp = {kStart + from_seconds(at_s), run, sequence};
  out.action = action;
  return out;
}

TEST(PlannerLease, KeepsTheFirstPlannerUntilItIsSilent) {
  PlannerLease lease;
  EXPECT_TRUE(lease.admit(1, kStart, 2.0));
  EXPECT_FALSE(lease.admit(2, kStart + from_seconds(1.0), 2.0));
  EXPECT_TRUE(lease.is_contested(kStart + from_seconds(1.5), 2.0));
  EXPECT_TRUE(lease.admit(1, kStart + from_seconds(1.9), 2.0));
  EXPECT_FALSE(lease.admit(2, kStart + from_seconds(3.8), 2.0));
  EXPECT_TRUE(lease.admit(2, kStart + from_seconds(4.0), 2.0));
  EXPECT_FALSE(lease.admit(1, kStart + from_seconds(4.1), 2.0))
      << "the earlier planner does not regain the lease";
  EXPECT_EQ(lease.takeovers(), 1);
}

class Authority : public testing::Test {
 protected:
  bool admit(OperatorAction action, std::int64_t run, double at_s) {
    return authority.admit(command(action, run, sequence++, at_s), kStart + from_seconds(at_s),
                           kSilentS);
  }
  OperatorAuthority authority;
  std::int64_t sequence = 0;
};

TEST_F(Authority, AcceptsSaferCommandsFromAnyStation) {
  EXPECT_FALSE(admit(OperatorAction::kArm, 1, 0.0)) << "no station has sent a heartbeat";
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.1));
  EXPECT_FALSE(admit(OperatorAction::kHeartbeat, 2, 0.2));
  for (const OperatorAction risky :
       {OperatorAction::kArm, OperatorAction::kTakeOff, OperatorAction::kFollow}) {
    EXPECT_TRUE(admit(risky, 1, 0.3));
    EXPECT_FALSE(admit(risky, 2, 0.3));
  }
  for (const OperatorAction safer :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    EXPECT_TRUE(admit(safer, 1, 0.4));
    EXPECT_TRUE(admit(safer, 2, 0.4));
  }
}

TEST_F(Authority, CountsOnlyTheHeartbeatOfTheStationInCharge) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  EXPECT_FALSE(admit(OperatorAction::kHeartbeat, 2, 0.5));
  EXPECT_TRUE(admit(OperatorAction::kHold, 2, 0.9));
  EXPECT_DOUBLE_EQ(authority.age_s(kStart + from_seconds(0.9)), 0.9);
}

TEST_F(Authority, PassesToAnotherStationOnlyAfterSilence) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  EXPECT_FALSE(admit(OperatorAction::kHeartbeat, 2, 0.9));
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 2, 1.1));
  EXPECT_FALSE(admit(OperatorAction::kArm, 1, 1.2));
  EXPECT_TRUE(admit(OperatorAction::kEmergencyStop, 1, 1.2))
      << "an emergency stop is accepted from any station";
  EXPECT_EQ(authority.handovers(), 1);
}

TEST_F(Authority, RefusesReplayedAndStaleCommands) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  const auto arm = command(OperatorAction::kArm, 1, 50, 0.1);
  EXPECT_TRUE(authority.admit(arm, kStart + from_seconds(0.1), kSilentS));
  EXPECT_FALSE(authority.admit(arm, kStart + from_seconds(0.2), kSilentS)) << "repeated";
  const auto old = command(OperatorAction::kArm, 1, 60, 0.2);
  EXPECT_FALSE(authority.admit(old, kStart + from_seconds(3.0), kSilentS)) << "2.8 s late";
  const auto stop = command(OperatorAction::kEmergencyStop, 9, 0, -3600.0);
  EXPECT_FALSE(authority.admit(stop, kStart + from_seconds(3.0), kSilentS)) << "from an old log";
  const auto own_stop = command(OperatorAction::kEmergencyStop, 1, 20, 0.05);
  EXPECT_FALSE(authority.admit(own_stop, kStart + from_seconds(3.0), kSilentS)) << "repeated";
  const auto late_stop = command(OperatorAction::kEmergencyStop, 1, 61, 0.3);
  EXPECT_TRUE(authority.admit(late_stop, kStart + from_seconds(3.0), kSilentS)) << "delayed";
}

TEST_F(Authority, AcceptsAStationAfterAClockChange) {
  double set_s = 0.0;
  int beats = 0;
  for (double at_s = 0.0; at_s < 100.0; at_s += 0.2) {
    if (++beats % 50 == 0) {
      set_s = 7200.0 * (beats % 3 - 1);
    }
    const auto beat = command(OperatorAction::kHeartbeat, 1, sequence++, at_s + set_s);
    EXPECT_TRUE(authority.admit(beat, kStart + from_seconds(at_s), kSilentS)) << at_s;
    const auto follow = command(OperatorAction::kFollow, 1, sequence++, at_s + set_s + 0.05);
    EXPECT_TRUE(authority.admit(follow, kStart + from_seconds(at_s + 0.05), kSilentS));
    const auto replayed = command(OperatorAction::kLand, 1, sequence - 3, at_s + set_s - 8.0);
    EXPECT_FALSE(authority.admit(replayed, kStart + from_seconds(at_s + 0.1), kSilentS));
  }
}

TEST_F(Authority, IsNotTakenOverByAReplayedLog) {
  for (double at_s = 0.0; at_s < 10.0; at_s += 0.2) {
    const auto beat = command(OperatorAction::kHeartbeat, 9, sequence++, at_s - 86400.0);
    EXPECT_FALSE(authority.admit(beat, kStart + from_seconds(at_s), kSilentS));
    const auto stop = command(OperatorAction::kEmergencyStop, 9, sequence++, at_s - 86400.0);
    EXPECT_FALSE(authority.admit(stop, kStart + from_seconds(at_s), kSilentS));
  }
}

TEST_F(Authority, KeepsTheStationInChargeAmongManyOthers) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  for (int run = 100; run < 200; ++run) {
    EXPECT_FALSE(admit(OperatorAction::kHeartbeat, run, 0.1));
  }
  EXPECT_TRUE(admit(OperatorAction::kArm, 1, 0.2));
}

// A station with a changed clock is accepted if its sequence numbers continue, with fewer than a
// hundred lost messages. Messages of a later part of a replayed log are not accepted.
TEST_F(Authority, AcceptsAClockChangeWhenNumbersContinue) {
  for (const std::int64_t lost : {0, 99, 100, 100'000}) {
    authority = {};
    sequence = 5;
    EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
    const auto beat = command(OperatorAction::kHeartbeat, 1, sequence + lost, 7200.2);
    EXPECT_EQ(authority.admit(beat, kStart + from_seconds(0.2), kSilentS), lost < 100) << lost;
  }
}

// An order is outdated if both its sequence number and its stamp are lower than those of the newest
// message.
TEST_F(Authority, RefusesOutdatedOrders) {
  EXPECT_TRUE(authority.admit(command(OperatorAction::kHeartbeat, 1, 10, 0.0), kStart, kSilentS));
  const auto admit_at = [&](std::int64_t number, double stamped_s, double at_s) {
    return authority.admit(command(OperatorAction::kArm, 1, number, stamped_s),
                           kStart + from_seconds(at_s), kSilentS);
  };
  for (const double begin_s : {0.0, 1.0}) {  // repeated later
    const auto first = static_cast<std::int64_t>(20 + 10 * begin_s);
    EXPECT_TRUE(admit_at(first + 2, begin_s + 0.3, begin_s + 0.31));
    EXPECT_FALSE(admit_at(first + 1, begin_s + 0.2, begin_s + 0.32));
    EXPECT_TRUE(admit_at(first + 1, begin_s + 0.4, begin_s + 0.41)) << "newer stamp";
    EXPECT_TRUE(admit_at(first + 4, begin_s + 0.3, begin_s + 0.42)) << "newer number";
  }
}

TEST(PlannerLease, LastsForItsDuration) {
  constexpr double kLeaseS = 2.0;
  const auto at = [](double t_s) { return kStart + from_seconds(t_s); };
  PlannerLease lease;
  EXPECT_EQ(lease.age_s(at(0.0)), kNever);
  EXPECT_TRUE(lease.is_holder(1));
  EXPECT_TRUE(lease.is_holder(2)) << "no run holds the lease";
  EXPECT_FALSE(lease.is_contested(at(0.0), kLeaseS));
  EXPECT_TRUE(lease.admit(1, at(0.0), kLeaseS));
  for (int time = 0; time < 2; ++time) {
    const double begin_s = 10.0 * time;
    const std::int64_t holder = 1 + time;
    EXPECT_TRUE(lease.admit(holder, at(begin_s), kLeaseS));
    EXPECT_EQ(lease.takeovers(), time);
    EXPECT_TRUE(lease.is_holder(holder));
    EXPECT_FALSE(lease.is_holder(holder + 1));
    EXPECT_FALSE(lease.is_contested(at(begin_s + 0.5), kLeaseS));
    EXPECT_FALSE(lease.admit(holder + 1, at(begin_s + 1.5), kLeaseS));
    EXPECT_TRUE(lease.is_contested(at(begin_s + 3.4), kLeaseS));
    EXPECT_FALSE(lease.is_contested(at(begin_s + 3.6), kLeaseS))
        << "the other planner is silent again";
    EXPECT_NEAR(lease.age_s(at(begin_s + 1.9)), 1.9, 1e-9)
        << "messages of another run do not count";
    EXPECT_FALSE(lease.admit(holder + 1, at(begin_s + 1.99), kLeaseS));
    EXPECT_TRUE(lease.admit(holder + 1, at(begin_s + 2.01), kLeaseS));
    EXPECT_NEAR(lease.age_s(at(begin_s + 3.0)), 0.99, 1e-9);
  }
}

TEST_F(Authority, CountsStaleCommandsTakeoversAndClockChanges) {
  const auto expect_counts = [&](std::int64_t handovers, std::int64_t other_time,
                                 std::int64_t clock_set) {
    std::vector<models::NamedCount> counts;
    authority.count(counts);
    ASSERT_EQ(counts.size(), 3U);
    EXPECT_EQ(counts[0].name, "operator.handovers");
    EXPECT_EQ(counts[1].name, "operator.other_time");
    EXPECT_EQ(counts[2].name, "operator.clock_set");
    EXPECT_EQ(counts[0].count, handovers);
    EXPECT_EQ(counts[1].count, other_time);
    EXPECT_EQ(counts[2].count, clock_set);
  };
  const auto beat = [&](std::int64_t run, double at_s, double ahead_s) {
    return authority.admit(command(OperatorAction::kHeartbeat, run, sequence++, at_s + ahead_s),
                           kStart + from_seconds(at_s), kSilentS);
  };
  EXPECT_EQ(authority.age_s(kStart), kNever);
  expect_counts(0, 0, 0);
  EXPECT_TRUE(beat(1, 0.0, 0.0));
  for (std::int64_t time = 0; time < 3; ++time) {
    const double begin_s = 10.0 * static_cast<double>(time);
    EXPECT_FALSE(beat(9, begin_s + 0.1, 3600.0)) << "from a log";
    EXPECT_TRUE(beat(time + 1, begin_s, 3600.0)) << "its clock was set";
    expect_counts(time, time + 1, 2 * time + 1);
    EXPECT_TRUE(beat(time + 1, begin_s + 0.2, 3600.0)) << "continues with its new clock";
    expect_counts(time, time + 1, 2 * time + 1);
    EXPECT_TRUE(beat(time + 1, begin_s + 0.4, 0.0)) << "its clock was set back";
    expect_counts(time, time + 1, 2 * time + 2);
    EXPECT_TRUE(beat(time + 1, begin_s + 0.6, 0.0));
    expect_counts(time, time + 1, 2 * time + 2);
    EXPECT_TRUE(beat(time + 2, begin_s + 10.0, 0.0));
    expect_counts(time + 1, time + 1, 2 * time + 2);
  }
}

TEST_F(Authority, AcceptsStampsWithinTwoSeconds) {
  for (const double side : {1.0, -1.0}) {
    for (const auto& [ahead_s, is_heard] : {std::pair(1.99, true), std::pair(2.01, false)}) {
      authority = {};
      const auto beat = command(OperatorAction::kHeartbeat, 1, 0, side * ahead_s);
      EXPECT_EQ(authority.admit(beat, kStart, kSilentS), is_heard) << side * ahead_s;
      // No station is known yet, so even a stop is compared with the clock of this computer.
      authority = {};
      const auto stop = command(OperatorAction::kEmergencyStop, 1, 0, side * ahead_s);
      EXPECT_EQ(authority.admit(stop, kStart, kSilentS), is_heard) << side * ahead_s;
    }
  }
}

// Eight stations are remembered. A ninth replaces the one that was silent longest, but never the
// one in charge. Late commands that make the vehicle safer are accepted only from remembered
// stations.
TEST_F(Authority, ForgetsTheLongestSilentStation) {
  const auto is_known = [&](std::int64_t run) {
    OperatorAuthority copy = authority;  // copy, so that the check does not change the state
    return copy.admit(command(OperatorAction::kHold, run, 1'000, 0.0), kStart + from_seconds(100.0),
                      kSilentS);
  };
  for (std::int64_t run = 1; run <= 8; ++run) {
    admit(OperatorAction::kHeartbeat, run, 0.1 * static_cast<double>(run));
  }
  for (std::int64_t run = 1; run <= 8; ++run) {
    EXPECT_TRUE(is_known(run)) << run;
  }
  EXPECT_FALSE(is_known(9));
  admit(OperatorAction::kHeartbeat, 3, 0.9);  // station 4 is silent longest, apart from station 1
  admit(OperatorAction::kHeartbeat, 2, 0.95);
  for (const std::int64_t newcomer : {9, 10}) {
    admit(OperatorAction::kHeartbeat, newcomer, 0.96 + 0.001 * static_cast<double>(newcomer));
  }
  for (std::int64_t run = 1; run <= 10; ++run) {
    EXPECT_EQ(is_known(run), run != 4 && run != 5) << run;
  }
}

TEST(PlannerLease, IsUncontestedAtTimeZero) {
  PlannerLease lease;
  EXPECT_FALSE(lease.is_contested(Time{} + from_seconds(0.5), 2.0));
  EXPECT_TRUE(lease.admit(1, Time{}, 2.0));
  EXPECT_FALSE(lease.is_contested(Time{} + from_seconds(0.5), 2.0));
}

// A replayed heartbeat of any age neither sets the clock nor keeps its station in charge.
TEST_F(Authority, IgnoresTheClockOfReplayedHeartbeats) {
  for (const std::int64_t number : {5, 9, 10}) {  // 10: the newest heartbeat itself
    authority = {};
    const auto beat = [&](std::int64_t sequence_now, double stamped_s, double at_s) {
      return authority.admit(command(OperatorAction::kHeartbeat, 1, sequence_now, stamped_s),
                             kStart + from_seconds(at_s), kSilentS);
    };
    for (std::int64_t i = 0; i <= 10; ++i) {
      EXPECT_TRUE(beat(i, 0.1 * static_cast<double>(i), 0.1 * static_cast<double>(i)));
    }
    for (const double at_s : {4.0, 3600.0}) {  // repeated much later
      EXPECT_FALSE(beat(number, 0.1 * static_cast<double>(number), at_s)) << number;
      EXPECT_NEAR(authority.age_s(kStart + from_seconds(at_s)), at_s - 1.0, 1e-9);
      const auto stop =
          command(OperatorAction::kEmergencyStop, 1, number, 0.1 * static_cast<double>(number));
      EXPECT_FALSE(authority.admit(stop, kStart + from_seconds(at_s), kSilentS))
          << "with the old time";
    }
    EXPECT_TRUE(beat(11, 3600.5, 3600.5)) << "the same station with its old clock";
  }
}

// If the station in charge is silent, another station takes over with a new heartbeat. A replayed
// heartbeat, or an order, does not make a station take over.
TEST_F(Authority, PassesToAStationWithANewHeartbeat) {
  for (const std::int64_t first : {0, 1}) {  // ids of a station may have any value
    authority = {};
    EXPECT_TRUE(authority.admit(command(OperatorAction::kHeartbeat, first, 1, 0.0), kStart, 1.0));
    const auto received = command(OperatorAction::kHeartbeat, 7, 4, 0.5);
    EXPECT_FALSE(authority.admit(received, kStart + from_seconds(0.5), 1.0));
    EXPECT_FALSE(authority.admit(received, kStart + from_seconds(1.5), 1.0)) << "repeated";
    const auto arm = command(OperatorAction::kArm, 7, 5, 1.5);
    EXPECT_FALSE(authority.admit(arm, kStart + from_seconds(1.5), 1.0))
        << "the station sends no heartbeat";
    EXPECT_EQ(authority.handovers(), 0);
    const auto beat = command(OperatorAction::kHeartbeat, 7, 6, 1.6);
    EXPECT_TRUE(authority.admit(beat, kStart + from_seconds(1.6), 1.0));
    EXPECT_EQ(authority.handovers(), 1);
    const auto back = command(OperatorAction::kHeartbeat, 7, 7, 9.0);
    EXPECT_TRUE(authority.admit(back, kStart + from_seconds(9.0), 1.0));
    EXPECT_EQ(authority.handovers(), 1) << "only one handover";
  }
}

// A delayed stop is obeyed once but does not keep its station in charge. A delayed order is
// refused.
TEST_F(Authority, AcceptsDelayedSaferCommandsOnce) {
  const auto at = [](double t_s) { return kStart + from_seconds(t_s); };
  EXPECT_TRUE(authority.admit(command(OperatorAction::kHeartbeat, 1, 50, 0.0), at(0.0), 1.0));
  const auto newest = command(OperatorAction::kHold, 1, 50, 0.1);
  EXPECT_FALSE(authority.admit(newest, at(3.0), 1.0)) << "this number was received";
  for (const std::int64_t number : {51, 52}) {
    const auto late = command(OperatorAction::kHold, 1, number, 0.2);
    EXPECT_TRUE(authority.admit(late, at(3.0), 1.0)) << number;
    EXPECT_FALSE(authority.admit(late, at(4.0), 1.0)) << "repeated";
    EXPECT_NEAR(authority.age_s(at(4.0)), 4.0, 1e-9);
  }
  std::vector<models::NamedCount> before;
  authority.count(before);
  EXPECT_FALSE(authority.admit(command(OperatorAction::kArm, 1, 60, 0.3), at(4.0), 1.0));
  std::vector<models::NamedCount> after;
  authority.count(after);
  EXPECT_EQ(after[1].count, before[1].count + 1) << "operator.other_time";
  // The station continues with new messages; orders that were already outdated are still refused.
  EXPECT_TRUE(authority.admit(command(OperatorAction::kHeartbeat, 1, 53, 4.1), at(4.1), 1.0));
  EXPECT_TRUE(authority.admit(command(OperatorAction::kHold, 1, 54, 1.0), at(4.15), 1.0));
  EXPECT_FALSE(authority.admit(command(OperatorAction::kFollow, 1, 52, 4.05), at(4.2), 1.0));
  EXPECT_TRUE(authority.admit(command(OperatorAction::kFollow, 1, 55, 4.2), at(4.2), 1.0));
}

}  // namespace
}  // namespace vantage::drivers
