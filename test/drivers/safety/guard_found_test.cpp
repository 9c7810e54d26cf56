// Tests the detection of a vehicle that is in the air without an order of this guard.

#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/safety/one_vehicle.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

// A vehicle is found flying if its motors run without an order of this guard and it is more than
// 0.15 m above the last position where its motors were off. The vehicle must be visible; if it has
// been unseen for long, its autopilot must report the position.
struct Found {
  const char* what;
  void (*set)(OneVehicle&);
  bool flies, lands;
};

void PrintTo(const Found& found, std::ostream* out) { *out << found.what; }

class VehicleAtRestart : public testing::TestWithParam<Found> {};

TEST_P(VehicleAtRestart, IsRecognisedAsFlyingOrLanding) {
  OneVehicle one({0.3, 0.05, 1.5});
  GetParam().set(one);
  bool flies = false;
  bool lands = false;
  one.run(0.1, [&] {
    flies = flies || one.in().is_found_flying;
    lands = lands || one.in().is_found_landing;
  });
  EXPECT_EQ(flies, GetParam().flies);
  EXPECT_EQ(lands, GetParam().lands);
  const bool is_in_air = GetParam().flies || GetParam().lands;
  EXPECT_EQ(drivers::is_airborne(one.state()), is_in_air);
  EXPECT_TRUE(!lands || one.state() == FlightState::kLand);
  one.run(0.1);
  EXPECT_FALSE(one.in().is_found_flying && is_in_air) << "found only once";
}

INSTANTIATE_TEST_SUITE_P(
    Found, VehicleAtRestart,
    testing::Values(
        Found{"InOurMode", [](OneVehicle&) {}, true, false},
        Found{"LandingByItself",
              [](OneVehicle& one) {
                one.report.is_in_our_mode = false;
                one.report.is_landing_itself = true;
              },
              false, true},
        Found{"OfAnother", [](OneVehicle& one) { one.report.is_in_our_mode = false; }, false,
              false},
        Found{"WithoutMotors", [](OneVehicle& one) { one.report.armed = false; }, false, false},
        Found{"Low", [](OneVehicle& one) { one.position_m.z() = 0.14; }, false, false},
        Found{"HighEnough", [](OneVehicle& one) { one.position_m.z() = 0.16; }, true, false},
        Found{"WithTelemetryOfNow",
              [](OneVehicle& one) {
                one.position_m.z() = 0.1;
                one.run(1.5);
                one.sends_telemetry = false;
                one.run(0.3);
                one.position_m.z() = 1.5;
              },
              true, false},
        Found{"WithoutTelemetryForLong",
              [](OneVehicle& one) {
                one.position_m.z() = 0.1;
                one.run(1.5);
                one.sends_telemetry = false;
                one.run(0.5);
                one.position_m.z() = 1.5;
              },
              false, false},
        Found{"LandingLow",
              [](OneVehicle& one) {
                one.position_m.z() = 0.1;
                one.report.is_in_our_mode = false;
                one.report.is_landing_itself = true;
              },
              false, false},
        Found{"LittleAboveWhereItStood",
              [](OneVehicle& one) {
                one.report.armed = false;
                one.position_m.z() = 0.5;
                one.run(0.1);
                one.report.armed = true;
                one.position_m.z() = 0.64;
              },
              false, false},
        Found{"AboveWhereItStood",
              [](OneVehicle& one) {
                one.report.armed = false;
                one.position_m.z() = 0.5;
                one.run(0.1);
                one.report.armed = true;
                one.position_m.z() = 0.66;
              },
              true, false},
        Found{"WhereItWasSeenOffBeforeTheFirstHeartbeat",
              [](OneVehicle& one) {
                one.report.armed = one.sends_heartbeats = false;
                one.run(0.1);
                one.report.armed = one.sends_heartbeats = true;
              },
              true, false},
        Found{"OnceNotInOurModeAndThenInIt",
              [](OneVehicle& one) {
                one.report.is_in_our_mode = false;
                one.run(0.3);
                one.report.is_in_our_mode = true;
              },
              true, false},
        Found{"UnseenForNotLong", [](OneVehicle& one) { one.has_mocap = false; }, false, false},
        Found{"UnseenForLong",
              [](OneVehicle& one) {
                one.has_mocap = false;
                one.run(0.46);
                EXPECT_EQ(one.state(), FlightState::kIdle);
              },
              true, false},
        Found{"UnseenForLongAndItDoesNotKnow",
              [](OneVehicle& one) {
                one.has_mocap = one.report.has_position = false;
                one.run(2.0);
              },
              false, false},
        Found{"UnseenForLongWhereItWasOnceSeenAndItDoesNotKnow",
              [](OneVehicle& one) {
                one.report.is_in_our_mode = false;
                one.run(1.0);
                one.has_mocap = one.report.has_position = false;
                one.run(0.7);
                one.report.is_in_our_mode = true;
              },
              false, false},
        Found{"UnseenForLongOnceSeen",
              [](OneVehicle& one) {
                one.report.is_in_our_mode = false;
                one.run(1.0);
                one.has_mocap = false;
                one.run(0.7);
                one.report.is_in_our_mode = true;
              },
              true, false},
        Found{"UnseenForABreath",
              [](OneVehicle& one) {
                one.report.is_in_our_mode = false;
                one.run(1.0);
                one.has_mocap = false;
                one.run(0.1);
                one.report.is_in_our_mode = true;
              },
              false, false}),
    [](const auto& each) { return std::string(each.param.what); });

}  // namespace
}  // namespace vantage::test
