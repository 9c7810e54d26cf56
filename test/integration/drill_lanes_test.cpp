#include "test/integration/drill_lanes.hpp"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::test {
namespace {

models::VehicleStatus status_at_speed(const std::string& robot, Time now, double speed_mps,
                                      models::FlightState state = models::FlightState::kFollow) {
  models::VehicleStatus out;
  out.robot = robot;
  out.stamp.time = now;
  out.state = state;
  out.setpoint.x_m = speed_mps * 1e-6 * static_cast<double>(to_utime(now));
  return out;
}

/// Returns the events within `seconds` for Q1 and Q2, which are commanded at the given speeds.
std::vector<DrillLanes::Event> flown(DrillLanes& lanes, double seconds, double q1_mps,
                                     double q2_mps, models::FlightState q2_state) {
  std::vector<DrillLanes::Event> out;
  for (double t_s = 0.0; t_s < seconds; t_s += 0.1) {
    const Time now = from_utime(1'000'000) + from_seconds(t_s);
    lanes.on_status(status_at_speed("Q1", now, q1_mps));
    lanes.on_status(status_at_speed("Q2", now, q2_mps, q2_state));
    if (const auto event = lanes.due(now)) {
      lanes.happened(*event);
      out.push_back(*event);
    }
  }
  return out;
}

TEST(DrillLanes, GiveEachVehicleEventsUntilEachKindIsDone) {
  DrillLanes lanes({"hold", "plan-loss"}, 3, 1);
  const auto events = flown(lanes, 60.0, 1.0, 1.0, models::FlightState::kFollow);

  EXPECT_EQ(lanes.left(), 0);
  ASSERT_EQ(events.size(), 6U);
  std::map<std::string, int> kinds;
  std::map<std::string, int> robots;
  for (const auto& event : events) {
    ++kinds[event.what];
    ++robots[event.robot];
  }
  EXPECT_EQ(kinds, (std::map<std::string, int>{{"hold", 3}, {"plan-loss", 3}}));
  EXPECT_GE(robots["Q1"], 2);
  EXPECT_GE(robots["Q2"], 2);
}

TEST(DrillLanes, SkipSlowOrNotFollowingRobots) {
  DrillLanes lanes({"hold"}, 100, 1);
  for (const auto& event : flown(lanes, 30.0, 0.1, 1.0, models::FlightState::kHold)) {
    ADD_FAILURE() << event.robot;
  }
  EXPECT_EQ(lanes.left(), 100);
}

TEST(DrillLanes, SuppressEventsDuringRest) {
  DrillLanes lanes({"hold"}, 100, 1);
  lanes.on_status(status_at_speed("Q1", from_utime(1'000'000), 1.0));
  static_cast<void>(lanes.due(from_utime(1'000'000)));
  lanes.rest("Q1", from_utime(21'000'000));
  const auto events = flown(lanes, 30.0, 1.0, 0.0, models::FlightState::kFollow);
  EXPECT_LE(events.size(), 4U);
}

}  // namespace
}  // namespace vantage::test
