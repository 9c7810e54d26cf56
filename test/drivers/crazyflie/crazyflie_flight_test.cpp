#include <gtest/gtest.h>

#include "test/drivers/crazyflie/crazyflie_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

class CrazyflieFlight : public ::testing::TestWithParam<bool> {
 protected:
  CrazyflieBench bench{GetParam()};
};

TEST_P(CrazyflieFlight, TakesOffFollowsAndLands) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  EXPECT_EQ(bench.state(), FlightState::kHold);
  bench.run(2.0);
  EXPECT_NEAR(bench.height_m(), 1.0, 0.03);
  ASSERT_TRUE(bench.follow_straight(0.5)) << bench.reasons();
  EXPECT_EQ(bench.state(), FlightState::kFollow) << bench.reasons();
  bench.run(5.0);
  bench.command(OperatorAction::kLand);
  ASSERT_TRUE(bench.run_until([this] { return bench.state() == FlightState::kIdle; }, 25.0))
      << bench.reasons();
  EXPECT_LT(bench.height_m(), 0.02);
  EXPECT_LT(bench.descent_max_mps, 0.8) << "the vehicle did not fall";
  EXPECT_FALSE(bench.vehicle->are_motors_running());
  bench.run(5.0);
  EXPECT_TRUE(bench.is_sound());
  EXPECT_FALSE(bench.is_flying());
  EXPECT_TRUE(bench.reasons().empty()) << bench.reasons();
}

TEST_P(CrazyflieFlight, FliesTwice) {
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(bench.take_off()) << i << " " << bench.reasons();
    bench.run(1.0);
    bench.command(OperatorAction::kLand);
    ASSERT_TRUE(bench.run_until([this] { return bench.state() == FlightState::kIdle; }, 25.0))
        << bench.reasons();
    bench.run(4.0);
    EXPECT_TRUE(bench.is_sound()) << i;
  }
}

TEST_P(CrazyflieFlight, LandsBeforeItEnds) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.driver->end(false);
  EXPECT_EQ(bench.driver->end_facts(bench.now).in_flight, InFlight::kYes);
  ASSERT_TRUE(bench.run_until(
      [this] { return bench.driver->end_facts(bench.now).in_flight == InFlight::kNo; }, 25.0));
  EXPECT_LT(bench.height_m(), 0.02);
  EXPECT_LT(bench.descent_max_mps, 0.8);
  EXPECT_TRUE(bench.is_sound());
}

TEST_P(CrazyflieFlight, HurriedEndHandsTheLandingToTheVehicleAtOnce) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.driver->end(true);
  ASSERT_TRUE(
      bench.run_until([this] { return bench.driver->end_facts(bench.now).lands_itself; }, 1.0));
  bench.has_driver = false;  // from now on the vehicle lands without its driver
  bench.run(8.0);
  EXPECT_LT(bench.height_m(), 0.02);
  EXPECT_LT(bench.descent_max_mps, 0.8);
  EXPECT_TRUE(bench.is_sound());
}

TEST_P(CrazyflieFlight, EmergencyStopIsRepeatedUntilTheVehicleIsLocked) {
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  int lost = 0;
  bench.loses_sent = [&lost](const wire::crtp::Packet&) { return ++lost < 20; };
  bench.command(OperatorAction::kEmergencyStop);
  ASSERT_TRUE(bench.run_until([this] { return bench.is_locked(); }, 1.0));
  bench.run(0.3);
  EXPECT_EQ(bench.state(), FlightState::kKilled);
  bench.sent.clear();
  bench.run(0.3);
  for (const wire::crtp::Packet& packet : bench.sent) {
    EXPECT_NE(packet.port, wire::crtp::Port::kSetpoint);
    EXPECT_NE(packet.port, wire::crtp::Port::kSupervisor);
  }
}

INSTANTIATE_TEST_SUITE_P(Arming, CrazyflieFlight, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "byItself" : "byCommand"; });

TEST(CrazyflieDriver, ReadsEachTableOncePerFirmware) {
  CrazyflieBench bench;
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  EXPECT_EQ(bench.tables->stored, 2);
  bench.restart_driver();
  bench.sent.clear();
  ASSERT_TRUE(bench.run_until([&] { return bench.reasons().empty(); }, 5.0)) << bench.reasons();
  EXPECT_EQ(bench.tables->stored, 2);
}

TEST(CrazyflieDriver, SelectsEstimatorAndController) {
  CrazyflieBench bench;
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  EXPECT_EQ(bench.vehicle->parameter("stabilizer.estimator"), 2.0);
  EXPECT_EQ(bench.vehicle->parameter("stabilizer.controller"), 2.0);
}

// The firmware's filter does not converge to a heading that is opposite to its initial one.
TEST(CrazyflieDriver, StartsTheEstimateAtTheMocapPose) {
  CrazyflieBench bench;
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  EXPECT_NEAR(bench.vehicle->parameter("kalman.initialX"), 2.0, 0.02);
  EXPECT_NEAR(bench.vehicle->parameter("kalman.initialY"), 2.0, 0.02);
  EXPECT_NEAR(bench.vehicle->parameter("kalman.initialZ"), 0.0, 0.02);
  EXPECT_NEAR(bench.vehicle->parameter("kalman.initialYaw"), kPi / 2, 0.02);
}

TEST(CrazyflieDriver, ConnectsAgainToARestartedVehicle) {
  CrazyflieBench bench;
  ASSERT_TRUE(bench.ready()) << bench.reasons();
  bench.reaches_driver = false;
  bench.run(2.0);
  EXPECT_TRUE(bench.has_reason("no packet received"));
  bench.restart_vehicle();
  bench.reaches_driver = true;
  ASSERT_TRUE(bench.run_until([&] { return bench.reasons().empty(); }, 15.0)) << bench.reasons();
  EXPECT_EQ(bench.vehicle->parameter("stabilizer.controller"), 2.0);
  EXPECT_TRUE(bench.take_off()) << bench.reasons();
}

TEST(CrazyflieDriver, LandsWithALowBattery) {
  CrazyflieBench bench;
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.vehicle->set_battery_v(3.25);
  ASSERT_TRUE(bench.run_until([&] { return bench.state() == FlightState::kLand; }, 20.0))
      << bench.reasons();
  ASSERT_TRUE(bench.run_until([&] { return bench.state() == FlightState::kIdle; }, 25.0));
  EXPECT_TRUE(bench.is_sound());
}

}  // namespace
}  // namespace vantage::test
