#pragma once

#include "drivers/safety/conditions.hpp"

// Functions that build rows of condition tables, and the rows that all vehicle types share. The
// table of a vehicle type contains shared rows and its own rows. A table adapts a shared row if the
// reaction or the text must differ.

namespace vantage::drivers {

inline constexpr const char* kSelfRule = "automatic, clear_s after the fault ends";
inline constexpr const char* kOperatorRule = "fault ended, and the operator sends follow";
inline constexpr const char* kGroundRule = "fault ended, landed and disarmed";
inline constexpr const char* kRearmRule = "on the ground, fault ended, and the operator sends arm";

/// Optional fields of a row; Condition describes their meaning.
struct RowOptions {
  bool blocks_arming = false;
  double after_s = 0.0;
  bool yields = false;
  bool blocks_take_off = false;
  bool spares_pilot = false;
  bool distrusts_pose = false;
};
using Holds = bool (*)(const SafetyInputs& inputs, const SafetyLimits& limits);

constexpr Condition row_of(Severity severity, Clearing clearing, const char* clears,
                           const char* name, const char* limit, const RowOptions& options,
                           Holds when) {
  return {.name = name,
          .severity = severity,
          .clearing = clearing,
          .blocks_arming = options.blocks_arming,
          .after_s = options.after_s,
          .limit = limit,
          .clears = clears,
          .holds = when,
          .yields = options.yields,
          .blocks_take_off = options.blocks_take_off,
          .spares_pilot = options.spares_pilot,
          .distrusts_pose = options.distrusts_pose};
}
constexpr Condition kills(const char* name, const char* limit, const RowOptions& options,
                          Holds when) {
  return row_of(Severity::kKill, Clearing::kRearm, kRearmRule, name, limit, options, when);
}
constexpr Condition lands(const char* name, const char* limit, const RowOptions& options,
                          Holds when) {
  return row_of(Severity::kLand, Clearing::kGround, kGroundRule, name, limit, options, when);
}
constexpr Condition holds(const char* name, const char* limit, const RowOptions& options,
                          Holds when) {
  return row_of(Severity::kHold, Clearing::kSelf, kSelfRule, name, limit, options, when);
}
constexpr Condition holds_for_operator(const char* name, const char* limit,
                                       const RowOptions& options, Holds when) {
  return row_of(Severity::kHold, Clearing::kOperator, kOperatorRule, name, limit, options, when);
}
constexpr Condition notes(const char* name, const char* limit, const RowOptions& options,
                          Holds when) {
  return row_of(Severity::kNote, Clearing::kAtOnce, "at once", name, limit, options, when);
}

/// Returns `row` for a vehicle that stops instead of landing: the vehicle holds until the operator
/// sends `follow`.
constexpr Condition held_for_operator(Condition row) {
  row.severity = Severity::kHold;
  row.clearing = Clearing::kOperator;
  row.clears = kOperatorRule;
  return row;
}
/// Returns `row` with another text for its limit.
constexpr Condition limited(Condition row, const char* limit) {
  row.limit = limit;
  return row;
}
/// Returns `row` with another text for the rule that clears it.
constexpr Condition cleared(Condition row, const char* clears) {
  row.clears = clears;
  return row;
}
/// Returns `row` with another rule that clears it, and its text.
constexpr Condition cleared(Condition row, Clearing clearing, const char* clears) {
  row.clearing = clearing;
  row.clears = clears;
  return row;
}

namespace common {

inline constexpr Condition kEmergencyStop =
    kills("emergency stop", "a station requested the stop", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.emergency_stop; });
inline constexpr Condition kMotor = kills(
    "motor", "the autopilot reports a failed motor", {.blocks_arming = true, .spares_pilot = true},
    [](const SafetyInputs& in, const SafetyLimits&) { return in.motor_failed; });
inline constexpr Condition kFenceFar = kills(
    "fence far", "the vehicle's centre is > fence_kill_m outside the fence or above the ceiling",
    {.blocks_arming = true, .spares_pilot = true},
    [](const SafetyInputs& in, const SafetyLimits& lim) {
      return in.fence_centre_m < -lim.fence_kill_m;
    });
inline constexpr Condition kPoseLost =
    lands("pose lost", "pose_age_s > pose_age_land_s", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.pose_age_s > lim.pose_age_land_s;
          });
inline constexpr Condition kFence =
    lands("fence",
          "the vehicle's edge is > fence_land_m outside the fence; only inward motion is allowed",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.fence_now_m < -lim.fence_land_m;
          });
inline constexpr Condition kSeparationBreach =
    lands("separation breach", "the nearest body is closer than separation_land_m",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.separation_now_m < lim.separation_land_m;
          });
inline constexpr Condition kTrackingLost =
    lands("tracking lost", "tracking_error_m > tracking_land_m", {.after_s = 0.1},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.tracking_error_m > lim.tracking_land_m;
          });
inline constexpr Condition kBatteryCritical = lands(
    "battery critical", "battery share < battery_land_share",
    {.blocks_arming = true, .after_s = 3.0}, [](const SafetyInputs& in, const SafetyLimits& lim) {
      return in.battery_share < lim.battery_land_share;
    });
inline constexpr Condition kEnding =
    lands("ending", "the driver received a request to end", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.is_ending; });
inline constexpr Condition kPoseStale =
    holds("pose stale", "pose_age_s > pose_age_hold_s", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.pose_age_s > lim.pose_age_hold_s;
          });
inline constexpr Condition kPoseUncertain =
    holds("pose uncertain", "without mocap: pose_sigma_m > pose_sigma_hold_m",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.pose_sigma_m > lim.pose_sigma_hold_m;
          });
inline constexpr Condition kPoseVeryUncertain =
    lands("pose very uncertain", "without mocap: pose_sigma_m > pose_sigma_land_m",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.pose_sigma_m > lim.pose_sigma_land_m;
          });
inline constexpr Condition kPoseLate =
    holds("pose late", "pose latency > pose_latency_hold_s", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.pose_latency_s > lim.pose_latency_hold_s;
          });
inline constexpr Condition kPoseImplausible = holds_for_operator(
    "pose implausible", "pose_rejected_hold poses rejected in a row", {.blocks_arming = true},
    [](const SafetyInputs& in, const SafetyLimits& lim) {
      return in.poses_rejected >= lim.pose_rejected_hold;
    });
inline constexpr Condition kFenceAhead =
    holds("fence ahead", "the braking path leaves the fence", {},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.fence_stop_m < 0.0; });
inline constexpr Condition kObstacleAhead =
    holds("obstacle ahead", "the braking path meets an obstacle", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.obstacle_stop_m < 0.0; });
inline constexpr Condition kSeparation =
    cleared(holds("separation", "braking now would come within separation_hold_m of a body",
                  {.blocks_arming = true, .yields = true},
                  [](const SafetyInputs& in, const SafetyLimits& lim) {
                    return in.separation_stop_m < lim.separation_hold_m;
                  }),
            "automatic, clear_s after the fault ends; yield_s later if the nearest body is a robot "
            "whose name sorts first");
inline constexpr Condition kTracking =
    holds("tracking", "tracking_error_m > tracking_hold_m", {.after_s = 0.1},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.tracking_error_m > lim.tracking_hold_m;
          });
inline constexpr Condition kNoPlan = cleared(
    holds("no plan", "no plan received, or the plan has ended and plan_age_s > plan_age_hold_s", {},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return !in.has_plan || (in.plan_ended && in.plan_age_s > lim.plan_age_hold_s);
          }),
    Clearing::kAtOnce, "a plan passes the check and begins where the vehicle is");
inline constexpr Condition kPlannerLate =
    holds("planner late", "plans_late_hold plans in a row arrived after their deadlines", {},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.plans_late >= lim.plans_late_hold;
          });
inline constexpr Condition kMapDiffers =
    holds("map differs", "another process announces a different scenario", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.map_differs; });
inline constexpr Condition kOperatorQuiet = holds_for_operator(
    "operator quiet", "no heartbeat of the operator for operator_age_hold_s",
    {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
      return lim.needs_operator && in.operator_age_s > lim.operator_age_hold_s;
    });
inline constexpr Condition kDriverStalled =
    holds("driver stalled", "> stall_hold_s between two ticks of the driver", {},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.since_last_tick_s > lim.stall_hold_s;
          });
inline constexpr Condition kShortOfProcessor =
    lands("short of processor", "processor_wait_s > processor_wait_hold_s for 3 s",
          {.after_s = 3.0}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.processor_wait_s > lim.processor_wait_hold_s;
          });
inline constexpr Condition kWaitsForProcessor =
    holds("waits for processor", "processor_wait_s > processor_wait_hold_s", {},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.processor_wait_s > lim.processor_wait_hold_s;
          });
inline constexpr Condition kHostBusy =
    notes("host busy", "processor_wait_s > processor_wait_arm_s", {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.processor_wait_s > lim.processor_wait_arm_s;
          });
inline constexpr Condition kPoseUnsettled =
    notes("pose unsettled", "fewer than pose_frames_to_arm plausible poses in a row",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.poses_accepted < lim.pose_frames_to_arm;
          });
inline constexpr Condition kPlannerSilent = notes(
    "planner silent", "the planner that holds the lease has sent no message for plan_silent_warn_s",
    {}, [](const SafetyInputs& in, const SafetyLimits& lim) {
      return in.planner_age_s > lim.plan_silent_warn_s;
    });
inline constexpr Condition kTwoPlanners =
    notes("two planners", "a second planner published while another planner holds the lease",
          {.blocks_arming = true},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.second_planner; });
inline constexpr Condition kAnotherVersion =
    notes("another version",
          "a message of an unknown type was received in the last other_version_clear_s",
          {.blocks_arming = true}, [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.other_version_age_s < lim.other_version_clear_s;
          });
inline constexpr Condition kPlansRefused =
    notes("plans refused", "the newest plan did not pass the check", {},
          [](const SafetyInputs& in, const SafetyLimits&) { return in.plans_refused > 0; });
inline constexpr Condition kBatteryLow =
    notes("battery low", "battery share < battery_low_share", {.after_s = 1.0},
          [](const SafetyInputs& in, const SafetyLimits& lim) {
            return in.battery_share < lim.battery_low_share;
          });

}  // namespace common

}  // namespace vantage::drivers
