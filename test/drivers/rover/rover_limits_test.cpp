// Compares the limits that stop a rover, and the parameters of its steering, with
// docs/reference/rover-conditions.md. Both sides of each limit are tested.

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "drivers/rover/steering.hpp"
#include "test/drivers/rover/rover_bench.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::drivers {
namespace {

constexpr double kToleranceM = 0.15;

/// One row of the table in the document. `set` sets an input. `last` is the last permitted value of
/// the input; `last` + `step` is not permitted.
struct Stated {
  const char* name;
  Severity severity;
  Clearing clearing;
  double after_s;
  void (*set)(SafetyInputs& inputs, double value);
  double last;
  double step = 1e-9;
};

constexpr auto kKill = Severity::kKill;
constexpr auto kHold = Severity::kHold;
constexpr auto kSelf = Clearing::kSelf;
constexpr auto kOperator = Clearing::kOperator;

// Inputs with a lower limit are listed with inverted sign.
const Stated kStated[] = {
    {"fence far", kKill, Clearing::kRearm, 0.0,
     [](SafetyInputs& in, double v) { in.fence_centre_m = -v; }, 1.0},
    {"pose lost", kHold, kOperator, 0.0, [](SafetyInputs& in, double v) { in.pose_age_s = v; },
     0.5},
    {"pose stale", kHold, kSelf, 0.0, [](SafetyInputs& in, double v) { in.pose_age_s = v; }, 0.1},
    {"pose late", kHold, kSelf, 0.0, [](SafetyInputs& in, double v) { in.pose_latency_s = v; },
     0.1},
    {"pose implausible", kHold, kOperator, 0.0,
     [](SafetyInputs& in, double v) { in.poses_rejected = static_cast<int>(v); }, 2.0, 1.0},
    {"fence", kHold, kOperator, 0.0, [](SafetyInputs& in, double v) { in.fence_now_m = -v; }, 0.0},
    {"fence ahead", kHold, kSelf, 0.0, [](SafetyInputs& in, double v) { in.fence_stop_m = -v; },
     0.0},
    {"obstacle ahead", kHold, kSelf, 0.0,
     [](SafetyInputs& in, double v) { in.obstacle_stop_m = -v; }, 0.0},
    {"separation breach", kHold, kOperator, 0.0,
     [](SafetyInputs& in, double v) { in.separation_now_m = -v; }, -0.4},  // sum of two radii
    {"tracking lost", kHold, kOperator, 0.1,
     [](SafetyInputs& in, double v) { in.tracking_error_m = v; }, 5.0 * kToleranceM},
    {"tracking", kHold, kSelf, 0.1, [](SafetyInputs& in, double v) { in.tracking_error_m = v; },
     2.0 * kToleranceM},
    {"planner late", kHold, kSelf, 0.0,
     [](SafetyInputs& in, double v) { in.plans_late = static_cast<int>(v); }, 2.0, 1.0},
    {"rover silent", kHold, kSelf, 0.0, [](SafetyInputs& in, double v) { in.heartbeat_age_s = v; },
     0.5},
    {"commands not accepted", kHold, kSelf, 0.0,
     [](SafetyInputs& in, double v) { in.telemetry_age_s = v; }, 0.5},
    {"battery critical", kHold, kOperator, 3.0,
     [](SafetyInputs& in, double v) { in.battery_share = -v; }, -0.15},
    {"operator quiet", kHold, kOperator, 0.0,
     [](SafetyInputs& in, double v) { in.operator_age_s = v; }, 1.0},
    {"driver stalled", kHold, kSelf, 0.0,
     [](SafetyInputs& in, double v) { in.since_last_tick_s = v; }, 0.25},
    {"short of processor", kHold, kOperator, 3.0,
     [](SafetyInputs& in, double v) { in.processor_wait_s = v; }, 0.3},
    {"waits for processor", kHold, kSelf, 0.0,
     [](SafetyInputs& in, double v) { in.processor_wait_s = v; }, 0.3},
    {"host busy", Severity::kNote, Clearing::kAtOnce, 0.0,
     [](SafetyInputs& in, double v) { in.processor_wait_s = v; }, 0.15},
    {"another version", Severity::kNote, Clearing::kAtOnce, 0.0,
     [](SafetyInputs& in, double v) { in.other_version_age_s = -v; }, -5.0},
};

TEST(RoverLimits, MatchTheDocument) {
  scenario::Scenario scenario = test::RoverBench::scenario_for();
  scenario.robots[0].limits.radius_m = 0.2;
  scenario.planner.tracking_tolerance_m = kToleranceM;
  const SafetyLimits limits = limits_for(scenario, "R1");
  const auto rows = rover_conditions();
  for (const Stated& stated : kStated) {
    SCOPED_TRACE(stated.name);
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Condition& each) {
      return std::string(each.name) == stated.name;
    });
    ASSERT_NE(row, rows.end());
    EXPECT_STREQ(name_of(row->severity), name_of(stated.severity));
    EXPECT_STREQ(name_of(row->clearing), name_of(stated.clearing));
    EXPECT_EQ(row->after_s, stated.after_s);
    SafetyInputs inputs;
    stated.set(inputs, stated.last);
    EXPECT_FALSE(row->holds(inputs, limits)) << "at " << stated.last;
    stated.set(inputs, stated.last + stated.step);
    EXPECT_TRUE(row->holds(inputs, limits)) << "just beyond " << stated.last;
  }
  EXPECT_EQ(limits.clear_s, 0.5) << "time after which a condition counts as ended";
}

TEST(RoverLimits, SteeringAndProtocolMatchTheDocument) {
  const SteeringGains gains;
  EXPECT_EQ(gains.along_per_s, 1.5);
  EXPECT_EQ(gains.side_per_m2, 4.0);
  EXPECT_EQ(gains.turn_per_m, 3.2);
  EXPECT_EQ(gains.pivot_mps, 0.3);
  EXPECT_EQ(wire::rover::kWatchdogS, 0.2);
  EXPECT_EQ(wire::rover::kTelemetryPeriodS, 1.0 / 20.0);
  EXPECT_EQ(wire::rover::kCommandBytes, 40U);
  EXPECT_EQ(wire::rover::kTelemetryBytes, 56U);
}

}  // namespace
}  // namespace vantage::drivers
