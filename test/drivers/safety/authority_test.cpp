#include "drivers/safety/authority.hpp"

#include <gtest/gtest.h>

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

TEST(PlannerLease, ObeysTheFirstUntilItIsSilentForTheLease) {
  PlannerLease lease;
  EXPECT_TRUE(lease.admit(1, kStart, 2.0));
  EXPECT_FALSE(lease.admit(2, kStart + from_seconds(1.0), 2.0));
  EXPECT_TRUE(lease.is_contested(kStart + from_seconds(1.5), 2.0));
  EXPECT_TRUE(lease.admit(1, kStart + from_seconds(1.9), 2.0));
  EXPECT_FALSE(lease.admit(2, kStart + from_seconds(3.8), 2.0));
  EXPECT_TRUE(lease.admit(2, kStart + from_seconds(4.0), 2.0));
  EXPECT_FALSE(lease.admit(1, kStart + from_seconds(4.1), 2.0)) << "the one that woke up";
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

TEST_F(Authority, TakesWhatIsSaferFromAnyoneAndTheRestFromTheFirst) {
  EXPECT_FALSE(admit(OperatorAction::kArm, 1, 0.0)) << "nobody beats yet";
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
  EXPECT_TRUE(admit(OperatorAction::kEmergencyStop, 1, 1.2)) << "its stop is never silenced";
  EXPECT_EQ(authority.handovers(), 1);
}

TEST_F(Authority, TakesNoReplayedOrStaleCommandForLife) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  const auto arm = command(OperatorAction::kArm, 1, 50, 0.1);
  EXPECT_TRUE(authority.admit(arm, kStart + from_seconds(0.1), kSilentS));
  EXPECT_FALSE(authority.admit(arm, kStart + from_seconds(0.2), kSilentS)) << "twice";
  const auto old = command(OperatorAction::kArm, 1, 60, 0.2);
  EXPECT_FALSE(authority.admit(old, kStart + from_seconds(3.0), kSilentS)) << "2.8 s under way";
  const auto stop = command(OperatorAction::kEmergencyStop, 9, 0, -3600.0);
  EXPECT_FALSE(authority.admit(stop, kStart + from_seconds(3.0), kSilentS)) << "of an old log";
  const auto own_stop = command(OperatorAction::kEmergencyStop, 1, 20, 0.05);
  EXPECT_FALSE(authority.admit(own_stop, kStart + from_seconds(3.0), kSilentS)) << "said before";
  const auto late_stop = command(OperatorAction::kEmergencyStop, 1, 61, 0.3);
  EXPECT_TRUE(authority.admit(late_stop, kStart + from_seconds(3.0), kSilentS)) << "held up";
}

TEST_F(Authority, HearsAStationWhoseClockIsSet) {
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

TEST_F(Authority, IsTakenOverByNoLogHoweverItBeats) {
  for (double at_s = 0.0; at_s < 10.0; at_s += 0.2) {
    const auto beat = command(OperatorAction::kHeartbeat, 9, sequence++, at_s - 86400.0);
    EXPECT_FALSE(authority.admit(beat, kStart + from_seconds(at_s), kSilentS));
    const auto stop = command(OperatorAction::kEmergencyStop, 9, sequence++, at_s - 86400.0);
    EXPECT_FALSE(authority.admit(stop, kStart + from_seconds(at_s), kSilentS));
  }
}

TEST_F(Authority, RemembersTheOneInChargeHoweverManyOthersBeat) {
  EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
  for (int run = 100; run < 200; ++run) {
    EXPECT_FALSE(admit(OperatorAction::kHeartbeat, run, 0.1));
  }
  EXPECT_TRUE(admit(OperatorAction::kArm, 1, 0.2));
}

// A clock that was set is believed of a station whose numbers go on, and not of a later part of its
// log: a hundred messages may get lost meanwhile, no more.
TEST_F(Authority, FollowsAClockThatIsSetOnlyWhileTheNumbersGoOn) {
  for (const std::int64_t lost : {0, 99, 100, 100'000}) {
    authority = {};
    sequence = 5;
    EXPECT_TRUE(admit(OperatorAction::kHeartbeat, 1, 0.0));
    const auto beat = command(OperatorAction::kHeartbeat, 1, sequence + lost, 7200.2);
    EXPECT_EQ(authority.admit(beat, kStart + from_seconds(0.2), kSilentS), lost < 100) << lost;
  }
}

// Overtaken on the way: an order that was numbered and stamped before the newest one is over.
TEST_F(Authority, ObeysNoOrderThatWasOvertaken) {
  EXPECT_TRUE(authority.admit(command(OperatorAction::kHeartbeat, 1, 10, 0.0), kStart, kSilentS));
  const auto admit_at = [&](std::int64_t number, double stamped_s, double at_s) {
    return authority.admit(command(OperatorAction::kArm, 1, number, stamped_s),
                           kStart + from_seconds(at_s), kSilentS);
  };
  for (const double begin_s : {0.0, 1.0}) {  // and once more
    const auto first = static_cast<std::int64_t>(20 + 10 * begin_s);
    EXPECT_TRUE(admit_at(first + 2, begin_s + 0.3, begin_s + 0.31));
    EXPECT_FALSE(admit_at(first + 1, begin_s + 0.2, begin_s + 0.32));
    EXPECT_TRUE(admit_at(first + 1, begin_s + 0.4, begin_s + 0.41)) << "stamped later";
    EXPECT_TRUE(admit_at(first + 4, begin_s + 0.3, begin_s + 0.42)) << "numbered later";
  }
}

}  // namespace
}  // namespace vantage::drivers
