#include "bus/node/flights.hpp"

#include <gtest/gtest.h>

namespace vantage::bus {
namespace {

using models::FlightState;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kStart = from_utime(1'000'000'000);
using Names = std::vector<std::string>;

models::VehicleStatus status(const std::string& robot, FlightState state) {
  models::VehicleStatus out;
  out.robot = robot;
  out.state = state;
  return out;
}

TEST(Flights, KeepsAVehicleForOneSecondAfterItsStatus) {
  Flights flights({"Q1", "Q2"});
  flights.on_status(status("Q1", FlightState::kLand), kStart);
  flights.on_status(status("Q2", FlightState::kIdle), kStart);
  flights.on_status(status("Q9", FlightState::kFollow), kStart);
  EXPECT_EQ(flights.in_flight(kStart + seconds(1)), Names{"Q1"});
  EXPECT_EQ(flights.in_flight(kStart + seconds(1) + Duration{1}), Names{});
}

TEST(Flights, RemovesAVehicleOnTheGround) {
  for (const FlightState rest : {FlightState::kIdle, FlightState::kKilled}) {
    Flights flights({"Q1"});
    flights.on_status(status("Q1", FlightState::kFollow), kStart);
    flights.on_status(status("Q1", rest), kStart);
    EXPECT_EQ(flights.in_flight(kStart), Names{});
  }
}

TEST(EndAfterFlights, DelaysTheFirstRequestUntilTheLanding) {
  EndAfterFlights end;
  EXPECT_EQ(end.requests(0, true, kStart), 0);
  EXPECT_EQ(end.requests(1, true, kStart + seconds(10)), 0);
  EXPECT_EQ(end.requests(1, true, kStart + seconds(70)), 0) << "a minute counts from the request";
  EXPECT_EQ(end.requests(1, false, kStart + seconds(70)), 1);
}

TEST(EndAfterFlights, DelaysOnlyTheFirstRequestByAtMostOneMinute) {
  EndAfterFlights end;
  EXPECT_EQ(end.requests(1, true, kStart), 0);
  EXPECT_EQ(end.requests(1, true, kStart + EndAfterFlights::kPatience), 0);
  EXPECT_EQ(end.requests(1, true, kStart + EndAfterFlights::kPatience + Duration{1}), 1);
  EndAfterFlights hurried;
  EXPECT_EQ(hurried.requests(2, true, kStart), 2);
}

}  // namespace
}  // namespace vantage::bus
