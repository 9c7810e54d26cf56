#include "tools/console/station.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::OperatorAction;
using Role = Station::Role;
constexpr Time kStart = from_utime(1'700'000'000'000'000);

Time at(double seconds) { return kStart + from_seconds(seconds); }

models::OperatorCommand beat(std::int64_t run_id, Time stamp) {
  models::OperatorCommand out;
  out.stamp.time = stamp;
  out.stamp.run_id = run_id;
  return out;
}

/// Advances the time in steps of 0.1 s while the station `other` sends heartbeats (0: no other
/// station).
void pass(Station& station, double from_s, double to_s, std::int64_t other) {
  for (double t_s = from_s; t_s < to_s; t_s += 0.1) {
    if (other != 0) {
      station.on_command(beat(other, at(t_s)), at(t_s));
    }
    (void)station.tick(at(t_s));
  }
}

TEST(Station, TakesChargeWithoutOtherHeartbeat) {
  Station station(5, false, kStart);
  station.on_command(beat(5, kStart), kStart);  // the station's own heartbeat
  pass(station, 0.0, 0.6, 0);
  EXPECT_EQ(station.role(), Role::kListening);
  EXPECT_FALSE(station.sends_heartbeat());
  pass(station, 0.6, 1.0, 0);
  EXPECT_EQ(station.role(), Role::kInCharge);
  EXPECT_TRUE(station.sends_heartbeat());
  EXPECT_TRUE(station.may_send(OperatorAction::kArm));
}

TEST(Station, IsRefusedPermanentlyIfAnotherIsInCharge) {
  Station station(5, false, kStart);
  pass(station, 0.0, 1.0, 9);
  EXPECT_EQ(station.role(), Role::kRefused);
  pass(station, 1.0, 60.0, 0);
  EXPECT_EQ(station.role(), Role::kRefused);
  EXPECT_FALSE(station.sends_heartbeat());
  for (int action = 0; action <= static_cast<int>(OperatorAction::kLand); ++action) {
    EXPECT_FALSE(station.may_send(static_cast<OperatorAction>(action))) << action;
  }
}

// A replayed log, or one old packet, does not make the station give up control.
TEST(Station, IgnoresOutdatedHeartbeat) {
  Station station(5, false, kStart);
  for (double t_s = 0.0; t_s < 3.0; t_s += 0.1) {
    station.on_command(beat(1, at(t_s) - std::chrono::hours(24)), at(t_s));
    station.on_command(beat(1, at(t_s) + std::chrono::hours(24)), at(t_s));
    (void)station.tick(at(t_s));
  }
  EXPECT_EQ(station.role(), Role::kInCharge);
}

TEST(Station, MayAlwaysSendAnEmergencyStop) {
  for (const bool allowed : {false, true}) {
    Station station(5, allowed, kStart);
    EXPECT_TRUE(station.may_send(OperatorAction::kEmergencyStop));
    for (int i = 0; i < 50; ++i) {
      pass(station, 0.1 * i, 0.1 * (i + 1), i % 3 == 0 ? 9 : 0);
      EXPECT_TRUE(station.may_send(OperatorAction::kEmergencyStop));
    }
  }
}

TEST(Station, SecondStationTakesOverAfterSilence) {
  Station station(5, true, kStart);
  pass(station, 0.0, 10.0, 9);
  EXPECT_EQ(station.role(), Role::kSecond);
  EXPECT_FALSE(station.sends_heartbeat());
  EXPECT_TRUE(station.may_send(OperatorAction::kHold));
  EXPECT_TRUE(station.may_send(OperatorAction::kLand));
  EXPECT_FALSE(station.may_send(OperatorAction::kArm));
  EXPECT_FALSE(station.may_send(OperatorAction::kFollow));
  pass(station, 10.0, 11.0, 0);
  EXPECT_EQ(station.role(), Role::kSecond);
  pass(station, 11.0, 12.0, 0);
  EXPECT_EQ(station.role(), Role::kInCharge);
}

TEST(Station, OneOfTwoSimultaneousStationsYields) {
  Station low(3, false, kStart);
  Station high(4, false, kStart);
  int beating = 0;
  for (double t_s = 0.0; t_s < 5.0; t_s += 0.1) {
    (void)low.tick(at(t_s));
    (void)high.tick(at(t_s));
    if (low.sends_heartbeat()) {
      high.on_command(beat(3, at(t_s)), at(t_s));
    }
    if (high.sends_heartbeat()) {
      low.on_command(beat(4, at(t_s)), at(t_s));
    }
    beating = (low.sends_heartbeat() ? 1 : 0) + (high.sends_heartbeat() ? 1 : 0);
  }
  EXPECT_EQ(beating, 1);
  EXPECT_EQ(low.role(), Role::kInCharge);
  EXPECT_EQ(high.role(), Role::kRefused);
}

}  // namespace
}  // namespace vantage::tools
