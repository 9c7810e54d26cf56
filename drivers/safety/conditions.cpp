#include "drivers/safety/conditions.hpp"

#include <array>

#include "drivers/safety/common_conditions.hpp"

// The table of conditions. To change the reaction to a fault, change its row. Rows are ordered by
// severity and, within one severity, by importance to a reader.

namespace vantage::drivers {
namespace {

using In = SafetyInputs;
using Lim = SafetyLimits;

constexpr Condition kTilt =
    kills("tilt", "tilt_rad > tilt_kill_rad",
          {.blocks_arming = true, .after_s = 0.1, .spares_pilot = true},
          [](const In& in, const Lim& lim) { return in.tilt_rad > lim.tilt_kill_rad; });
constexpr Condition kPoseLostLow = kills(
    "pose lost low",
    "pose_age_s > pose_age_kill_s while the vehicle is below safe_height_m or outside the fence; "
    "not checked while a pilot flies or poses are distrusted",
    {}, [](const In& in, const Lim& lim) {
      // While poses are distrusted, the height may be that of another body, so it is not compared.
      return !in.is_pose_distrusted && in.autopilot_obeys && in.pose_age_s > lim.pose_age_kill_s &&
             (in.height_m < lim.safe_height_m || in.fence_centre_m < 0.0);
    });
constexpr Condition kBodyDoesNotLift =
    kills("body does not lift",
          "take-off commanded, but the body has not risen by lift_risen_m within lift_wait_s",
          {.spares_pilot = true},
          [](const In& in, const Lim& lim) { return in.no_rise_s > lim.lift_wait_s; });
constexpr Condition kAnotherBodyLifts =
    kills("another body lifts",
          "another robot's body rises by lift_other_rise_m before this one has risen",
          {.spares_pilot = true},
          [](const In& in, const Lim& lim) { return in.other_risen_m > lim.lift_other_rise_m; });
constexpr Condition kLiftOffCourse =
    kills("lift off course", "the vehicle is > lift_deviation_m from the path of the first lift",
          {.spares_pilot = true},
          [](const In& in, const Lim& lim) { return in.lift_deviation_m > lim.lift_deviation_m; });
constexpr Condition kLiftDisagrees =
    kills("lift disagrees", "first lift: climb or turn rates of mocap and autopilot differ",
          {.after_s = 0.1, .spares_pilot = true}, [](const In& in, const Lim& lim) {
            return in.lift_climb_error_mps > lim.lift_climb_error_mps ||
                   in.lift_turn_error_radps > lim.lift_turn_error_radps;
          });
constexpr Condition kUncommandedRise = kills(
    "uncommanded rise", "the armed vehicle has risen by lift_other_rise_m without a take-off order",
    {.spares_pilot = true},
    [](const In& in, const Lim& lim) { return in.unordered_rise_m > lim.lift_other_rise_m; });
constexpr Condition kLiftUnproven =
    lands("lift unproven",
          "in the first hover, mocap has not shown the commanded motion within lift_proof_s", {},
          [](const In& in, const Lim& lim) { return in.proof_pending_s > lim.lift_proof_s; });
constexpr Condition kBatteryEmpty = lands(
    "battery empty", "battery share < battery_empty_share", {.blocks_arming = true},
    [](const In& in, const Lim& lim) { return !(in.battery_share >= lim.battery_empty_share); });
constexpr Condition kBatterySilent =
    lands("battery silent", "no battery report for battery_age_land_s", {.blocks_arming = true},
          [](const In& in, const Lim& lim) { return in.battery_age_s > lim.battery_age_land_s; });
constexpr Condition kBatteryStuck = lands(
    "battery stuck", "the battery report is unchanged for battery_stuck_land_s in flight", {},
    [](const In& in, const Lim& lim) { return in.battery_unchanged_s > lim.battery_stuck_land_s; });
constexpr Condition kFlightTime =
    lands("flight time", "in the air for flight_max_s", {},
          [](const In& in, const Lim& lim) { return in.flight_s > lim.flight_max_s; });
// LAND instead of KILL: autopilots report a hot speed controller or a weak motor as a failed motor.
// If the vehicle cannot fly, it tilts and the condition `tilt` acts.
constexpr Condition kMotor =
    lands("motor", "the autopilot reports a failed motor or a loss of thrust",
          {.blocks_arming = true}, [](const In& in, const Lim&) { return in.motor_failed; });
constexpr Condition kAutopilotLost = lands(
    "autopilot lost", "no heartbeat of the autopilot for heartbeat_age_land_s",
    {.blocks_arming = true},
    [](const In& in, const Lim& lim) { return in.heartbeat_age_s > lim.heartbeat_age_land_s; });
constexpr Condition kEstimateLost = lands(
    "estimate lost", "estimate_error_m > estimate_error_land_m", {.blocks_arming = true},
    [](const In& in, const Lim& lim) { return in.estimate_error_m > lim.estimate_error_land_m; });
constexpr Condition kEstimatorFailed =
    lands("estimator failed", "the autopilot reports that its position estimate is unreliable",
          {.blocks_arming = true, .after_s = 1.0},
          [](const In& in, const Lim&) { return !in.estimator_good; });
constexpr Condition kPoseForeign =
    lands("pose foreign",
          "velocities of mocap and autopilot differ by > velocity_error_land_mps; the driver stops "
          "using the poses",
          {.after_s = 0.3, .distrusts_pose = true}, [](const In& in, const Lim& lim) {
            return in.velocity_error_mps > lim.velocity_error_land_mps;
          });
constexpr Condition kHoverUnsteady =
    lands("hover unsteady",
          "commanded to hover, but faster than hover_speed_mps or > hover_off_m from the hover "
          "point; the driver stops using the poses",
          {.after_s = 2.0, .distrusts_pose = true},
          [](const In& in, const Lim&) { return in.is_hover_deviating; });
constexpr Condition kDoesNotSink = lands(
    "does not sink",
    "in descent, but > sink_error_m above the commanded height; the driver stops using the poses",
    {.after_s = 2.0, .distrusts_pose = true},
    [](const In& in, const Lim& lim) { return in.sink_error_m > lim.sink_error_m; });
constexpr Condition kOperatorLost =
    lands("operator lost", "no heartbeat of the operator for operator_age_land_s",
          {.blocks_arming = true}, [](const In& in, const Lim& lim) {
            return lim.needs_operator && in.operator_age_s > lim.operator_age_land_s;
          });
constexpr Condition kTooFast =
    holds("too fast", "speed_mps > speed_hold_ratio × speed_max_mps", {.after_s = 0.2},
          [](const In& in, const Lim& lim) {
            return in.speed_mps > lim.speed_hold_ratio * lim.vehicle.speed_max_mps;
          });
constexpr Condition kFoundFlying = holds_for_operator(
    "found flying", "in the air without a take-off by this driver", {.blocks_arming = true},
    [](const In& in, const Lim&) { return in.is_found_flying || in.is_found_landing; });
constexpr Condition kAutopilotQuiet = holds(
    "autopilot quiet", "no heartbeat of the autopilot for heartbeat_age_hold_s",
    {.blocks_arming = true},
    [](const In& in, const Lim& lim) { return in.heartbeat_age_s > lim.heartbeat_age_hold_s; });
constexpr Condition kTelemetryStale = holds(
    "telemetry stale", "no telemetry for telemetry_age_hold_s", {.blocks_arming = true},
    [](const In& in, const Lim& lim) { return in.telemetry_age_s > lim.telemetry_age_hold_s; });
constexpr Condition kEstimateOff = holds(
    "estimate off", "estimate_error_m > estimate_error_hold_m",
    {.blocks_arming = true, .after_s = 0.1},
    [](const In& in, const Lim& lim) { return in.estimate_error_m > lim.estimate_error_hold_m; });
constexpr Condition kVelocityDisagrees = holds(
    "velocity disagrees", "velocities of mocap and autopilot differ by > velocity_error_hold_mps",
    {.after_s = 0.1}, [](const In& in, const Lim& lim) {
      return in.velocity_error_mps > lim.velocity_error_hold_mps;
    });
constexpr Condition kEstimatorDoubtful =
    holds("estimator doubtful", "the autopilot reports that its position estimate is unreliable",
          {.blocks_arming = true, .after_s = 0.2},
          [](const In& in, const Lim&) { return !in.estimator_good; });
constexpr Condition kAutopilotDisobeys = holds_for_operator(
    "autopilot disobeys", "the autopilot left the mode that accepts set-points", {.after_s = 0.5},
    [](const In& in, const Lim&) { return !in.autopilot_obeys; });
constexpr Condition kPoseAging =
    notes("pose aging", "pose_age_s > pose_age_warn_s; the vehicle follows its plan more slowly",
          {}, [](const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_warn_s; });
constexpr Condition kBodyTilted =
    notes("body tilted", "body_tilt_rad > body_tilt_arm_rad while the vehicle is on the ground",
          {.blocks_arming = true}, [](const In& in, const Lim& lim) {
            return in.flight_s <= 0.0 && in.body_tilt_rad > lim.body_tilt_arm_rad;
          });
constexpr Condition kNotAtItsStart =
    notes("not at its start",
          "before its first flight, the vehicle is > start_off_arm_m away from, or turned by > "
          "start_turn_arm_rad against, its start in the scenario",
          {.blocks_arming = true}, [](const In& in, const Lim& lim) {
            return in.flight_s <= 0.0 && (in.start_off_m > lim.start_off_arm_m ||
                                          in.start_turn_rad > lim.start_turn_arm_rad);
          });
constexpr Condition kAttitudeDisagrees =
    notes("attitude disagrees",
          "tilts of mocap and autopilot differ by > attitude_error_arm_rad while the vehicle is on "
          "the ground",
          {.blocks_arming = true}, [](const In& in, const Lim& lim) {
            return in.flight_s <= 0.0 && in.attitude_error_rad > lim.attitude_error_arm_rad;
          });
constexpr Condition kYawDisagrees = notes(
    "yaw disagrees",
    "yaws of mocap and autopilot differ by > yaw_error_arm_rad while the vehicle is on the ground",
    {.blocks_arming = true}, [](const In& in, const Lim& lim) {
      return in.flight_s <= 0.0 && in.yaw_error_rad > lim.yaw_error_arm_rad;
    });
constexpr Condition kAnotherVehicleIsLifting = notes(
    "another vehicle is lifting",
    "vehicles lift one at a time, in the order of their take-off commands, then of their names",
    {.blocks_take_off = true},
    [](const In& in, const Lim&) { return in.flight_s <= 0.0 && in.is_lift_blocked; });
constexpr Condition kBodyNearby =
    notes("body nearby",
          "on the ground, and a body will come within landing_clearance_m in the next "
          "take_off_prediction_s",
          {.blocks_take_off = true}, [](const In& in, const Lim& lim) {
            return in.flight_s <= 0.0 && in.near_m < lim.landing_clearance_m;
          });
constexpr Condition kBatteryForTakeOff = notes(
    "battery for take-off", "battery share < battery_arm_share while the vehicle is on the ground",
    {.blocks_arming = true}, [](const In& in, const Lim& lim) {
      return in.flight_s <= 0.0 && !(in.battery_share >= lim.battery_arm_share);
    });

constexpr auto kRows = std::to_array<Condition>({
    // Conditions that cause KILL.
    common::kEmergencyStop,
    kTilt,
    common::kFenceFar,
    kPoseLostLow,
    kBodyDoesNotLift,
    kAnotherBodyLifts,
    kLiftOffCourse,
    kLiftDisagrees,
    kUncommandedRise,
    // Conditions that cause LAND.
    common::kPoseLost,
    common::kFence,
    common::kSeparationBreach,
    common::kTrackingLost,
    kLiftUnproven,
    kBatteryEmpty,
    common::kBatteryCritical,
    kBatterySilent,
    kBatteryStuck,
    kFlightTime,
    kMotor,
    kAutopilotLost,
    kEstimateLost,
    kEstimatorFailed,
    kPoseForeign,
    kHoverUnsteady,
    kDoesNotSink,
    kOperatorLost,
    common::kShortOfProcessor,
    common::kEnding,
    // Conditions that cause HOLD.
    common::kPoseStale,
    common::kPoseLate,
    common::kPoseImplausible,
    common::kFenceAhead,
    common::kObstacleAhead,
    common::kSeparation,
    common::kTracking,
    kTooFast,
    kFoundFlying,
    common::kNoPlan,
    common::kPlannerLate,
    common::kMapDiffers,
    kAutopilotQuiet,
    kTelemetryStale,
    kEstimateOff,
    kVelocityDisagrees,
    kEstimatorDoubtful,
    kAutopilotDisobeys,
    common::kOperatorQuiet,
    common::kDriverStalled,
    common::kWaitsForProcessor,
    // The rows below do not change the state: they are only reported, slow the plan, or forbid
    // arming.
    kPoseAging,
    common::kPoseUnsettled,
    kBodyTilted,
    kNotAtItsStart,
    kAttitudeDisagrees,
    kYawDisagrees,
    kAnotherVehicleIsLifting,
    kBodyNearby,
    common::kPlannerSilent,
    common::kTwoPlanners,
    common::kAnotherVersion,
    common::kPlansRefused,
    common::kBatteryLow,
    kBatteryForTakeOff,
    common::kHostBusy,
});
static_assert(kRows.size() <= kConditionsMax);

}  // namespace

std::span<const Condition> conditions() { return kRows; }

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kHold:
      return "hold";
    case Severity::kLand:
      return "land";
    case Severity::kKill:
      return "kill";
  }
  return "?";
}

const char* name_of(Clearing clearing) {
  switch (clearing) {
    case Clearing::kAtOnce:
      return "at once";
    case Clearing::kSelf:
      return "by itself";
    case Clearing::kOperator:
      return "operator";
    case Clearing::kGround:
      return "on the ground";
    case Clearing::kRearm:
      return "re-arm";
  }
  return "?";
}

}  // namespace vantage::drivers
