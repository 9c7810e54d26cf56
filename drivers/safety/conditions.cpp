#include "drivers/safety/conditions.hpp"

#include <array>

// The table. To change what the vehicle does when something fails, change a row. Rows are ordered
// by severity and, within one, by what a reader looks for first.

namespace vantage::drivers {
namespace {

using In = SafetyInputs;
using Lim = SafetyLimits;
constexpr auto kKill = Severity::kKill;
constexpr auto kLand = Severity::kLand;
constexpr auto kHold = Severity::kHold;
constexpr auto kNote = Severity::kNote;
constexpr auto kAtOnce = Clearing::kAtOnce;
constexpr auto kSelf = Clearing::kSelf;
constexpr auto kOperator = Clearing::kOperator;
constexpr auto kGround = Clearing::kGround;
constexpr auto kRearm = Clearing::kRearm;

constexpr const char* kSelfRule = "by itself, gone for clear_s";
constexpr const char* kOperatorRule = "gone, and the operator says follow";
constexpr const char* kGroundRule = "gone, landed and disarmed";
constexpr const char* kRearmRule = "on the ground, gone, and the operator says arm";

bool is_lost(const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_land_s; }

constexpr auto kRows = std::to_array<Condition>({
    // KILL
    {"emergency stop", kKill, kRearm, true, 0.0, "any station asked", kRearmRule,
     [](const In& in, const Lim&) { return in.emergency_stop; }},
    {"tilt", kKill, kRearm, true, 0.1, "tilt_rad > tilt_kill_rad", kRearmRule,
     [](const In& in, const Lim& lim) { return in.tilt_rad > lim.tilt_kill_rad; }},
    {"motor", kKill, kRearm, true, 0.0, "the autopilot reports a failed motor", kRearmRule,
     [](const In& in, const Lim&) { return in.motor_failed; }},
    {"fence far", kKill, kRearm, true, 0.0, "centre > fence_kill_m outside or above the ceiling",
     kRearmRule,
     [](const In& in, const Lim& lim) { return in.fence_centre_m < -lim.fence_kill_m; }},
    {"pose lost low", kKill, kRearm, false, 0.0,
     "pose_age_s > pose_age_kill_s and height < safe_height_m or outside", kRearmRule,
     [](const In& in, const Lim& lim) {
       return in.pose_age_s > lim.pose_age_kill_s &&
              (in.height_m < lim.safe_height_m || in.fence_centre_m < 0.0);
     }},
    {"body does not lift", kKill, kRearm, false, 0.0,
     "told to take off, and not risen lift_risen_m in lift_wait_s", kRearmRule,
     [](const In& in, const Lim& lim) { return in.unrisen_s > lim.lift_wait_s; }},
    {"another body lifts", kKill, kRearm, false, 0.0,
     "lift_other_m by another robot's body, before this one has risen", kRearmRule,
     [](const In& in, const Lim& lim) { return in.other_risen_m > lim.lift_other_m; }},
    {"lift astray", kKill, kRearm, false, 0.0, "> lift_astray_m from its place in the first lift",
     kRearmRule, [](const In& in, const Lim& lim) { return in.lift_astray_m > lim.lift_astray_m; }},
    {"lift disagrees", kKill, kRearm, false, 0.1,
     "first lift: climb or turn of the body against the autopilot's own", kRearmRule,
     [](const In& in, const Lim& lim) {
       return in.lift_climb_error_mps > lim.lift_climb_error_mps ||
              in.lift_turn_error_radps > lim.lift_turn_error_radps;
     }},
    {"rises untold", kKill, kRearm, false, 0.0, "armed, not told, and risen lift_other_m",
     kRearmRule, [](const In& in, const Lim& lim) { return in.risen_untold_m > lim.lift_other_m; }},
    // LAND
    {"pose lost", kLand, kGround, true, 0.0, "pose_age_s > pose_age_land_s", kGroundRule, is_lost},
    {"fence", kLand, kGround, true, 0.0, "edge > fence_land_m outside; moves inward only",
     kGroundRule, [](const In& in, const Lim& lim) { return in.fence_now_m < -lim.fence_land_m; }},
    {"separation breach", kLand, kGround, true, 0.0, "nearest body < separation_land_m",
     kGroundRule,
     [](const In& in, const Lim& lim) { return in.separation_now_m < lim.separation_land_m; }},
    {"tracking lost", kLand, kGround, false, 0.1, "tracking_error_m > tracking_land_m", kGroundRule,
     [](const In& in, const Lim& lim) { return in.tracking_error_m > lim.tracking_land_m; }},
    {"lift unproven", kLand, kGround, false, 0.0,
     "lift_proof_s in the first hover, and not gone where it was told", kGroundRule,
     [](const In& in, const Lim& lim) { return in.unproven_s > lim.lift_proof_s; }},
    {"battery empty", kLand, kGround, true, 0.0, "share < battery_empty_share", kGroundRule,
     [](const In& in, const Lim& lim) { return !(in.battery_share >= lim.battery_empty_share); }},
    {"battery critical", kLand, kGround, true, 3.0, "share < battery_land_share", kGroundRule,
     [](const In& in, const Lim& lim) { return in.battery_share < lim.battery_land_share; }},
    {"battery silent", kLand, kGround, true, 0.0, "no word for battery_age_land_s", kGroundRule,
     [](const In& in, const Lim& lim) { return in.battery_age_s > lim.battery_age_land_s; }},
    {"battery stuck", kLand, kGround, false, 0.0, "unchanged for battery_stuck_land_s in flight",
     kGroundRule,
     [](const In& in,
        const Lim& lim) { return in.battery_unchanged_s > lim.battery_stuck_land_s; }},
    {"flight time", kLand, kGround, false, 0.0, "in the air for flight_max_s", kGroundRule,
     [](const In& in, const Lim& lim) { return in.flight_s > lim.flight_max_s; }},
    {"thrust saturated", kLand, kGround, false, 1.0, "thrust_share > thrust_saturated_share",
     kGroundRule,
     [](const In& in, const Lim& lim) { return in.thrust_share > lim.thrust_saturated_share; }},
    {"autopilot lost", kLand, kGround, true, 0.0, "no heartbeat for heartbeat_age_land_s",
     kGroundRule,
     [](const In& in, const Lim& lim) { return in.heartbeat_age_s > lim.heartbeat_age_land_s; }},
    {"estimate lost", kLand, kGround, true, 0.0, "estimate_error_m > estimate_error_land_m",
     kGroundRule,
     [](const In& in, const Lim& lim) { return in.estimate_error_m > lim.estimate_error_land_m; }},
    {"estimator failed", kLand, kGround, true, 1.0, "the autopilot's estimator is not good",
     kGroundRule, [](const In& in, const Lim&) { return !in.estimator_good; }},
    {"operator lost", kLand, kGround, true, 0.0, "no heartbeat for operator_age_land_s",
     kGroundRule,
     [](const In& in,
        const Lim&
            lim) { return lim.needs_operator && in.operator_age_s > lim.operator_age_land_s; }},
    // HOLD
    {"pose stale", kHold, kSelf, true, 0.0, "pose_age_s > pose_age_hold_s", kSelfRule,
     [](const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_hold_s; }},
    {"pose late", kHold, kSelf, true, 0.0, "latency > pose_latency_hold_s", kSelfRule,
     [](const In& in, const Lim& lim) { return in.pose_latency_s > lim.pose_latency_hold_s; }},
    {"pose implausible", kHold, kOperator, true, 0.0, "pose_rejected_hold poses in a row",
     kOperatorRule,
     [](const In& in, const Lim& lim) { return in.poses_rejected >= lim.pose_rejected_hold; }},
    {"fence ahead", kHold, kSelf, false, 0.0, "the braking way leaves the fence", kSelfRule,
     [](const In& in, const Lim&) { return in.fence_stop_m < 0.0; }},
    {"obstacle ahead", kHold, kSelf, true, 0.0, "the braking way meets an obstacle", kSelfRule,
     [](const In& in, const Lim&) { return in.obstacle_stop_m < 0.0; }},
    {"separation", kHold, kSelf, true, 0.0, "braking now comes within separation_hold_m of a body",
     "by itself, gone for clear_s; yield_s more for the later name of the two",
     [](const In& in, const Lim& lim) { return in.separation_stop_m < lim.separation_hold_m; },
     true},
    {"tracking", kHold, kSelf, false, 0.1, "tracking_error_m > tracking_hold_m", kSelfRule,
     [](const In& in, const Lim& lim) { return in.tracking_error_m > lim.tracking_hold_m; }},
    {"too fast", kHold, kSelf, false, 0.2, "speed_mps > speed_hold_ratio × speed_max_mps",
     kSelfRule,
     [](const In& in,
        const Lim&
            lim) { return in.speed_mps > lim.speed_hold_ratio * lim.vehicle.speed_max_mps; }},
    {"found flying", kHold, kOperator, true, 0.0, "in the air, and not by this driver's doing",
     kOperatorRule,
     [](const In& in, const Lim&) { return in.is_found_flying || in.is_found_landing; }},
    {"no plan", kHold, kAtOnce, false, 0.0,
     "no plan, or it has ended and plan_age_s > plan_age_hold_s",
     "a plan passes the check and begins where the vehicle is",
     [](const In& in,
        const Lim&
            lim) { return !in.has_plan || (in.plan_ended && in.plan_age_s > lim.plan_age_hold_s); }},
    {"planner late", kHold, kSelf, false, 0.0, "plans_late_hold plans in a row after the deadline",
     kSelfRule, [](const In& in, const Lim& lim) { return in.plans_late >= lim.plans_late_hold; }},
    {"map differs", kHold, kSelf, true, 0.0, "another scenario is announced", kSelfRule,
     [](const In& in, const Lim&) { return in.map_differs; }},
    {"autopilot quiet", kHold, kSelf, true, 0.0, "no heartbeat for heartbeat_age_hold_s", kSelfRule,
     [](const In& in, const Lim& lim) { return in.heartbeat_age_s > lim.heartbeat_age_hold_s; }},
    {"telemetry stale", kHold, kSelf, true, 0.0, "no telemetry for telemetry_age_hold_s", kSelfRule,
     [](const In& in, const Lim& lim) { return in.telemetry_age_s > lim.telemetry_age_hold_s; }},
    {"estimate off", kHold, kSelf, true, 0.1, "estimate_error_m > estimate_error_hold_m", kSelfRule,
     [](const In& in, const Lim& lim) { return in.estimate_error_m > lim.estimate_error_hold_m; }},
    {"estimator doubtful", kHold, kSelf, true, 0.2, "the autopilot's estimator is not good",
     kSelfRule, [](const In& in, const Lim&) { return !in.estimator_good; }},
    {"autopilot disobeys", kHold, kOperator, false, 0.5, "it left the mode that takes set-points",
     kOperatorRule, [](const In& in, const Lim&) { return !in.autopilot_obeys; }},
    {"operator quiet", kHold, kOperator, true, 0.0, "no heartbeat for operator_age_hold_s",
     kOperatorRule,
     [](const In& in,
        const Lim&
            lim) { return lim.needs_operator && in.operator_age_s > lim.operator_age_hold_s; }},
    {"own stall", kHold, kSelf, false, 0.0, "stall_hold_s between two ticks", kSelfRule,
     [](const In& in, const Lim& lim) { return in.since_last_tick_s > lim.stall_hold_s; }},
    // Said, and slowed or refused on the ground, but no change of state
    {"pose aging", kNote, kAtOnce, false, 0.0, "pose_age_s > pose_age_warn_s; slows the plan",
     "at once", [](const In& in, const Lim& lim) { return in.pose_age_s > lim.pose_age_warn_s; }},
    {"pose unsettled", kNote, kAtOnce, true, 0.0, "fewer than pose_frames_to_arm plausible poses",
     "at once",
     [](const In& in, const Lim& lim) { return in.poses_accepted < lim.pose_frames_to_arm; }},
    {"body tilted", kNote, kAtOnce, true, 0.0, "body_tilt_rad > body_tilt_arm_rad; on the ground",
     "at once",
     [](const In& in,
        const Lim& lim) { return in.flight_s <= 0.0 && in.body_tilt_rad > lim.body_tilt_arm_rad; }},
    {"not at its start", kNote, kAtOnce, true, 0.0,
     "further than start_off_arm_m or turned by more than start_turn_arm_rad from the scenario's start; before its first flight",
     "at once",
     [](const In& in, const Lim& lim) {
       return in.flight_s <= 0.0 && (in.start_off_m > lim.start_off_arm_m ||
                                     in.start_turn_rad > lim.start_turn_arm_rad);
     }},
    {"attitude disagrees", kNote, kAtOnce, true, 0.0,
     "level by mocap and autopilot > attitude_error_arm_rad; on the ground", "at once",
     [](const In& in, const Lim& lim) {
       return in.flight_s <= 0.0 && in.attitude_error_rad > lim.attitude_error_arm_rad;
     }},
    {"yaw disagrees", kNote, kAtOnce, true, 0.0,
     "yaw by mocap and autopilot > yaw_error_arm_rad; on the ground", "at once",
     [](const In& in, const Lim& lim) {
       return in.flight_s <= 0.0 && in.yaw_error_rad > lim.yaw_error_arm_rad;
     }},
    {"another vehicle is lifting", kNote, kAtOnce, false, 0.0,
     "one lifts at a time: told first, then by name; on the ground", "at once",
     [](const In& in, const Lim&) { return in.flight_s <= 0.0 && in.is_lift_taken; }, false, true},
    {"somebody near", kNote, kAtOnce, false, 0.0,
     "a body within landing_clearance_m in take_off_look_s; on the ground", "at once",
     [](const In& in, const Lim& lim) {
       return in.flight_s <= 0.0 && in.near_m < lim.landing_clearance_m;
     },
     false, true},
    {"planner silent", kNote, kAtOnce, false, 0.0, "leaseholder silent for plan_silent_warn_s",
     "at once",
     [](const In& in, const Lim& lim) { return in.planner_age_s > lim.plan_silent_warn_s; }},
    {"two planners", kNote, kAtOnce, true, 0.0, "a run without the lease spoke within the lease",
     "at once", [](const In& in, const Lim&) { return in.second_planner; }},
    {"another version", kNote, kAtOnce, true, 0.0,
     "a message of no type of ours, in the last other_version_clear_s", "at once",
     [](const In& in, const Lim& lim) {
       return in.other_version_age_s < lim.other_version_clear_s;
     }},
    {"plans refused", kNote, kAtOnce, false, 0.0, "the newest plan did not pass the check",
     "at once", [](const In& in, const Lim&) { return in.plans_refused > 0; }},
    {"battery low", kNote, kAtOnce, false, 1.0, "share < battery_low_share", "at once",
     [](const In& in, const Lim& lim) { return in.battery_share < lim.battery_low_share; }},
    {"battery for take-off", kNote, kAtOnce, true, 0.0, "share < battery_arm_share; on the ground",
     "at once",
     [](const In& in,
        const Lim&
            lim) { return in.flight_s <= 0.0 && !(in.battery_share >= lim.battery_arm_share); }},
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
