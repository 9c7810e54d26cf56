#include "drivers/safety/conditions.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/drivers/safety/flight_bench.hpp"

// Tests values on both sides of the limit, for each row of the table that compares a number with a
// limit.

namespace vantage::drivers {
namespace {

using In = SafetyInputs;

SafetyLimits limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

const Condition& row_of(const std::string& name) {
  const auto rows = conditions();
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const Condition& row) { return row.name == name; });
  EXPECT_NE(found, rows.end()) << name;
  return found == rows.end() ? rows[0] : *found;
}

struct Edge {
  const char* name;
  double In::*input;
  double limit;
  bool is_upper = true;  ///< true: the condition is true above the limit; false: below it
};

std::vector<Edge> edges(const SafetyLimits& l) {
  return {
      {"tilt", &In::tilt_rad, l.tilt_kill_rad},
      {"fence far", &In::fence_centre_m, -l.fence_kill_m, false},
      {"body does not lift", &In::no_rise_s, l.lift_wait_s},
      {"another body lifts", &In::other_risen_m, l.lift_other_rise_m},
      {"lift off course", &In::lift_deviation_m, l.lift_deviation_m},
      {"lift disagrees", &In::lift_climb_error_mps, l.lift_climb_error_mps},
      {"lift disagrees", &In::lift_turn_error_radps, l.lift_turn_error_radps},
      {"uncommanded rise", &In::unordered_rise_m, l.lift_other_rise_m},
      {"pose lost", &In::pose_age_s, l.pose_age_land_s},
      {"fence", &In::fence_now_m, -l.fence_land_m, false},
      {"separation breach", &In::separation_now_m, l.separation_land_m, false},
      {"tracking lost", &In::tracking_error_m, l.tracking_land_m},
      {"lift unproven", &In::proof_pending_s, l.lift_proof_s},
      {"battery empty", &In::battery_share, l.battery_empty_share, false},
      {"battery critical", &In::battery_share, l.battery_land_share, false},
      {"battery silent", &In::battery_age_s, l.battery_age_land_s},
      {"battery stuck", &In::battery_unchanged_s, l.battery_stuck_land_s},
      {"flight time", &In::flight_s, l.flight_max_s},
      {"autopilot lost", &In::heartbeat_age_s, l.heartbeat_age_land_s},
      {"estimate lost", &In::estimate_error_m, l.estimate_error_land_m},
      {"pose foreign", &In::velocity_error_mps, l.velocity_error_land_mps},
      {"does not sink", &In::sink_error_m, l.sink_error_m},
      {"velocity disagrees", &In::velocity_error_mps, l.velocity_error_hold_mps},
      {"operator lost", &In::operator_age_s, l.operator_age_land_s},
      {"pose stale", &In::pose_age_s, l.pose_age_hold_s},
      {"pose late", &In::pose_latency_s, l.pose_latency_hold_s},
      {"fence ahead", &In::fence_stop_m, 0.0, false},
      {"obstacle ahead", &In::obstacle_stop_m, 0.0, false},
      {"separation", &In::separation_stop_m, l.separation_hold_m, false},
      {"tracking", &In::tracking_error_m, l.tracking_hold_m},
      {"too fast", &In::speed_mps, l.speed_hold_ratio * l.vehicle.speed_max_mps},
      {"autopilot quiet", &In::heartbeat_age_s, l.heartbeat_age_hold_s},
      {"telemetry stale", &In::telemetry_age_s, l.telemetry_age_hold_s},
      {"estimate off", &In::estimate_error_m, l.estimate_error_hold_m},
      {"operator quiet", &In::operator_age_s, l.operator_age_hold_s},
      {"driver stalled", &In::since_last_tick_s, l.stall_hold_s},
      {"short of processor", &In::processor_wait_s, l.processor_wait_hold_s},
      {"waits for processor", &In::processor_wait_s, l.processor_wait_hold_s},
      {"host busy", &In::processor_wait_s, l.processor_wait_arm_s},
      {"pose aging", &In::pose_age_s, l.pose_age_warn_s},
      {"body tilted", &In::body_tilt_rad, l.body_tilt_arm_rad},
      {"not at its start", &In::start_off_m, l.start_off_arm_m},
      {"not at its start", &In::start_turn_rad, l.start_turn_arm_rad},
      {"attitude disagrees", &In::attitude_error_rad, l.attitude_error_arm_rad},
      {"yaw disagrees", &In::yaw_error_rad, l.yaw_error_arm_rad},
      {"body nearby", &In::near_m, l.landing_clearance_m, false},
      {"planner silent", &In::planner_age_s, l.plan_silent_warn_s},
      {"another version", &In::other_version_age_s, l.other_version_clear_s, false},
      {"battery low", &In::battery_share, l.battery_low_share, false},
      {"battery for take-off", &In::battery_share, l.battery_arm_share, false},
  };
}

TEST(ConditionRow, IsTrueOnlyBeyondItsLimit) {
  const SafetyLimits l = limits();
  for (const Edge& edge : edges(l)) {
    const Condition& row = row_of(edge.name);
    SafetyInputs in;
    EXPECT_FALSE(row.holds(in, l)) << edge.name << ": of a healthy vehicle on the ground";
    in.*edge.input = edge.limit;
    EXPECT_FALSE(row.holds(in, l)) << edge.name << " at " << edge.limit;
    in.*edge.input += edge.is_upper ? 1e-9 : -1e-9;
    EXPECT_TRUE(row.holds(in, l)) << edge.name << " beyond " << edge.limit;
  }
}

// Except for the emergency stop, no row stops the motors of a vehicle that a pilot flies.
TEST(ConditionRow, KillsAPilotedVehicleOnlyByEmergencyStop) {
  for (const Condition& row : conditions()) {
    // The row "pose lost low" itself checks whether the autopilot still obeys.
    const bool asks_itself = std::string(row.name) == "pose lost low";
    const bool is_order = std::string(row.name) == "emergency stop";
    EXPECT_EQ(row.spares_pilot, row.severity == Severity::kKill && !is_order && !asks_itself)
        << row.name;
  }
}

// Conditions for a vehicle on the ground must be false in the air; otherwise they are reported
// during the whole flight.
TEST(ConditionRow, GroundRowIsFalseInTheAir) {
  const SafetyLimits l = limits();
  const std::set<std::string> of_the_ground = {"body tilted",   "not at its start",
                                               "yaw disagrees", "attitude disagrees",
                                               "body nearby",   "battery for take-off"};
  for (const Edge& edge : edges(l)) {
    SafetyInputs in;
    in.flight_s = 1.0;
    in.*edge.input = edge.limit + (edge.is_upper ? 1e-9 : -1e-9);
    EXPECT_EQ(row_of(edge.name).holds(in, l), !of_the_ground.contains(edge.name)) << edge.name;
  }
}

TEST(ConditionRow, OnACountIsTrueAtItsLimitAndAbove) {
  const SafetyLimits l = limits();
  const auto holds = [&](const char* name, int In::*input, int value) {
    SafetyInputs in;
    in.*input = value;
    return row_of(name).holds(in, l);
  };
  EXPECT_FALSE(holds("pose implausible", &In::poses_rejected, l.pose_rejected_hold - 1));
  EXPECT_TRUE(holds("pose implausible", &In::poses_rejected, l.pose_rejected_hold));
  EXPECT_FALSE(holds("planner late", &In::plans_late, l.plans_late_hold - 1));
  EXPECT_TRUE(holds("planner late", &In::plans_late, l.plans_late_hold));
  EXPECT_FALSE(holds("pose unsettled", &In::poses_accepted, l.pose_frames_to_arm));
  EXPECT_TRUE(holds("pose unsettled", &In::poses_accepted, l.pose_frames_to_arm - 1));
  EXPECT_FALSE(holds("plans refused", &In::plans_refused, 0));
  EXPECT_TRUE(holds("plans refused", &In::plans_refused, 1));
}

// Tests the rows that combine several inputs. "pose lost low" requires an old pose and a vehicle
// that is near the floor or outside. "no plan" requires that there is no plan or that the plan
// ended long ago.
TEST(ConditionRow, IsTrueOnlyIfAllItsRequirementsAreMet) {
  const SafetyLimits l = limits();
  SafetyInputs in;
  in.pose_age_s = l.pose_age_kill_s + 1e-9;
  in.height_m = l.safe_height_m;
  in.fence_centre_m = 0.0;
  EXPECT_FALSE(row_of("pose lost low").holds(in, l)) << "high and inside";
  in.height_m = l.safe_height_m - 1e-9;
  EXPECT_TRUE(row_of("pose lost low").holds(in, l));
  in.height_m = l.safe_height_m;
  in.fence_centre_m = -1e-9;
  EXPECT_TRUE(row_of("pose lost low").holds(in, l));
  in.autopilot_obeys = false;
  EXPECT_FALSE(row_of("pose lost low").holds(in, l)) << "a pilot flies the vehicle";
  in.autopilot_obeys = true;
  in.pose_age_s = l.pose_age_kill_s;
  EXPECT_FALSE(row_of("pose lost low").holds(in, l)) << "the pose is new";
  for (const bool has_plan : {true, false}) {
    for (const bool has_ended : {true, false}) {
      for (const double beyond_s : {0.0, 1e-9}) {
        in = {};
        in.has_plan = has_plan;
        in.plan_ended = has_ended;
        in.plan_age_s = l.plan_age_hold_s + beyond_s;
        EXPECT_EQ(row_of("no plan").holds(in, l), !has_plan || (has_ended && beyond_s > 0.0));
      }
    }
  }
  SafetyLimits alone = l;
  alone.needs_operator = false;
  in = {};
  in.operator_age_s = 1e9;
  for (const char* name : {"operator quiet", "operator lost"}) {
    EXPECT_TRUE(row_of(name).holds(in, l)) << name;
    EXPECT_FALSE(row_of(name).holds(in, alone)) << name;
  }
}

TEST(NameOf, IsUniqueForEachSeverityAndClearing) {
  std::set<std::string> names = {"?"};
  for (const Severity each : {Severity::kNote, Severity::kHold, Severity::kLand, Severity::kKill}) {
    EXPECT_TRUE(names.insert(name_of(each)).second) << name_of(each);
  }
  names = {"?"};
  for (const Clearing each : {Clearing::kAtOnce, Clearing::kSelf, Clearing::kOperator,
                              Clearing::kGround, Clearing::kRearm}) {
    EXPECT_TRUE(names.insert(name_of(each)).second) << name_of(each);
  }
}

}  // namespace
}  // namespace vantage::drivers
