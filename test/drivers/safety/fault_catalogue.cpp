#include "test/drivers/safety/fault_catalogue.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;
constexpr auto kFollow = FlightState::kFollow;
constexpr auto kHold = FlightState::kHold;
constexpr auto kLand = FlightState::kLand;
constexpr auto kIdle = FlightState::kIdle;
constexpr auto kKilled = FlightState::kKilled;

// One tick of telemetry, one of ours, one for rounding.
constexpr double kTicks = 0.03;
// Plans come once a second.
constexpr double kRound = 1.0 + kTicks;

VehicleKnobs& q1(FlightBench& bench) { return bench.vehicle("Q1").knobs; }
VehicleKnobs& q2(FlightBench& bench) { return bench.vehicle("Q2").knobs; }

// Of two faults of one plan the first counts.
void spoil(VehicleKnobs& knobs, PlanFault fault) {
  knobs.plan = knobs.plan == PlanFault::kNone ? fault : knobs.plan;
}

template <BodyFault fault>
void body_always(FlightBench& bench, double) {
  q1(bench).body.push_back(fault);
}
template <int milliseconds, BodyFault fault>
void body_for(FlightBench& bench, double since_s) {
  if (since_s < 1e-3 * milliseconds) {
    q1(bench).body.push_back(fault);
  }
}
template <PlanFault fault>
void plan_always(FlightBench& bench, double) {
  spoil(q1(bench), fault);
}
template <PlanFault fault>
void plan_once(FlightBench& bench, double since_s) {
  if (since_s < 1.0) {
    spoil(q1(bench), fault);
  }
}
void late_always(FlightBench& bench, double) { q1(bench).plan_late = true; }
void late_once(FlightBench& bench, double since_s) { q1(bench).plan_late |= since_s < 1.0; }
// True during one tick only.
bool is_at(double since_s, double at_s) { return std::abs(since_s - at_s) < 0.004; }

std::vector<Fault> mocap_faults() {
  const std::vector<Stage> gone = {{kHold, 0.10 + kTicks}, {kLand, 0.50 + kTicks}};
  std::vector<Stage> to_the_end = gone;
  to_the_end.push_back({kKilled, 10.0});
  return {
      {1,
       "one frame without the body",
       "occluded for 10 ms",
       "Q1",
       0.0,
       body_for<10, BodyFault::kOccluded>,
       {},
       nullptr,
       "pose.absent",
       kFollow},
      {2,
       "outage 0.1 s",
       "occluded for 0.15 s",
       "Q1",
       0.0,
       body_for<150, BodyFault::kOccluded>,
       {{kHold, 0.10 + kTicks}},
       "pose stale",
       nullptr,
       kFollow},
      {2, "outage 0.5 s", "occluded for 0.6 s", "Q1", 0.0, body_for<600, BodyFault::kOccluded>,
       gone, "pose lost", nullptr, kIdle},
      {2, "outage 2 s", "occluded for 2 s", "Q1", 0.0, body_for<2000, BodyFault::kOccluded>, gone,
       "pose lost", nullptr, kIdle},
      {2, "outage for good", "absent from then on", "Q1", 0.0, body_always<BodyFault::kAbsent>,
       to_the_end, "pose lost low", nullptr, kKilled},
      {3, "camera server dies", "no frame at all", "all", 0.0,
       [](FlightBench& bench, double) { bench.room().mocap_dead = true; }, to_the_end,
       "pose lost low", nullptr, kKilled},
      {4, "stuck while moving", "the last pose again and again", "Q1", 0.0,
       body_always<BodyFault::kFrozen>, to_the_end, "pose stale", nullptr, kKilled},
      {4,
       "stuck while hovering",
       "the same, after `hold`",
       "Q1",
       2.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kHold;
         }
         if (since_s >= 2.0) {
           q1(bench).body.push_back(BodyFault::kFrozen);
         }
       },
       {{kHold, kTicks}, {kLand, 0.55 + kTicks}, {kKilled, 10.0}},
       "pose lost",
       nullptr,
       kKilled},
      {5,
       "two bodies swapped for 0.3 s",
       "Q1 and Q2 carry each other's name",
       "Q1 Q2",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.3) {
           q1(bench).swapped_with = "Q2";
           q2(bench).swapped_with = "Q1";
         }
       },
       {{kHold, 0.10 + kTicks}},
       "pose implausible",
       nullptr,
       kHold},
      {5, "two bodies swapped for good", "Q1 and Q2 carry each other's name", "Q1 Q2", 0.0,
       [](FlightBench& bench, double) {
         q1(bench).swapped_with = "Q2";
         q2(bench).swapped_with = "Q1";
       },
       to_the_end, "pose implausible", nullptr, kKilled},
      {6,
       "ghost body",
       "an unknown name 0.1 m beside Q1",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().ghost_body = true; },
       {},
       nullptr,
       "mocap.unknown_bodies",
       kFollow},
      {6, "two bodies of one name", "the second 0.4 m away", "Q1", 0.0,
       body_always<BodyFault::kDuplicated>, to_the_end, "pose lost", nullptr, kKilled},
      {7,
       "outlier of 1 m in one frame",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         q1(bench).offset_m += since_s < 0.005 ? 1.0 : 0.0;
       },
       {},
       nullptr,
       "pose.jump",
       kFollow},
      {7, "jump of 1 m for good", "", "Q1", 0.0,
       [](FlightBench& bench, double) { q1(bench).offset_m = 1.0; }, to_the_end, "pose implausible",
       nullptr, kKilled},
      {7,
       "flipped in one frame",
       "upside down",
       "Q1",
       0.0,
       body_for<5, BodyFault::kUpsideDown>,
       {},
       nullptr,
       "pose.flip",
       kFollow},
      {7, "flipped for good", "upside down", "Q1", 0.0, body_always<BodyFault::kUpsideDown>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no number", "NaN in a position", "Q1", 0.0, body_always<BodyFault::kNotANumber>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no rotation", "zero quaternion", "Q1", 0.0, body_always<BodyFault::kZeroQuaternion>,
       to_the_end, "pose implausible", nullptr, kKilled},
      {8, "no unit rotation", "quaternion of length 1.5", "Q1", 0.0,
       body_always<BodyFault::kLongQuaternion>, to_the_end, "pose implausible", nullptr, kKilled},
      {8, "millimetres for metres", "", "Q1", 0.0, body_always<BodyFault::kMillimetres>, to_the_end,
       "pose implausible", nullptr, kKilled},
      {8, "frame mirrored in flight", "y changes its sign", "Q1", 0.0,
       body_always<BodyFault::kMirrored>, to_the_end, "pose implausible", nullptr, kKilled},
      {9,
       "rate falls to 20 Hz",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_every = 5; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.05},
      {9,
       "rate falls to 8 Hz",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_every = 12; },
       {{kHold, 0.22 + kTicks}},
       "pose stale",
       nullptr,
       kHold},
      {9,
       "latency 5 to 35 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().mocap_latency_s = std::max(0.035, bench.room().mocap_latency_s);
       },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.04},
      {9,
       "latency 5 to 155 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().mocap_latency_s = std::max(0.155, bench.room().mocap_latency_s);
       },
       {{kHold, 0.10 + kTicks}},
       "pose late",
       nullptr,
       kHold},
      {9,
       "jitter of 50 ms",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_jitter_s = 0.05; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.06},
      {10,
       "mocap clock one hour on",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_clock = std::chrono::hours(1); },
       {},
       nullptr,
       "mocap.clock_set",
       kFollow},
      {10,
       "mocap clock one hour back",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().mocap_clock = -std::chrono::hours(1); },
       {},
       nullptr,
       "mocap.clock_set",
       kFollow},
      {10,
       "mocap clock drifts by 1 %",
       "runs ahead",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         bench.room().mocap_clock = from_seconds(0.01 * since_s);
       },
       {},
       nullptr,
       nullptr,
       kFollow},
      {12,
       "20 % of the frames lost",
       "at random",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().frame_loss = 0.2; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.04},
  };
}

std::vector<Fault> plan_faults() {
  const auto refused = [](int number, const char* name, const char* what, auto act,
                          const char* counter) {
    return Fault{number, name, what, "Q1", 0.0, act, {}, nullptr, counter, kFollow, false};
  };
  const std::vector<Stage> at_plan_end = {{kHold, 3.0 + kTicks}};
  return {
      refused(14, "late plan after a newer one", "starts 1 s earlier",
              plan_once<PlanFault::kHalfASecondOld>, "plan.stale"),
      {15,
       "planner cut off for 0.7 s",
       "plans do not arrive",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.7) {
           spoil(q1(bench), PlanFault::kDropped);
         }
       },
       {},
       nullptr,
       nullptr,
       kFollow},
      {15, "planner cut off for 5 s, then back", "plans do not arrive", "Q1", 0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 5.0) {
           spoil(q1(bench), PlanFault::kDropped);
         }
       },
       at_plan_end, "no plan", nullptr, kFollow},
      {23, "planner killed", "", "Q1", 0.0,
       [](FlightBench& bench, double) { q1(bench).planner_dead = true; }, at_plan_end, "no plan",
       nullptr, kHold},
      {24,
       "stopped leader wakes up",
       "a second planner took over from a silent one",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 4.0) {
           spoil(q1(bench), PlanFault::kDropped);
         }
         q1(bench).second_planner = true;
       },
       {{kHold, 4.0}},
       "two planners",
       "plan.no lease",
       kFollow},
      {25,
       "two planners",
       "a second run plans a hover each round",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).second_planner = true; },
       {},
       "two planners",
       "plan.no lease",
       kFollow},
      refused(26, "one plan after its deadline", "", late_once, nullptr),
      {26,
       "every plan after its deadline",
       "",
       "Q1",
       0.0,
       late_always,
       {{kHold, 2.0 + kRound}},
       "planner late",
       nullptr,
       kHold},
      refused(27, "plan with NaN", "", plan_once<PlanFault::kNotANumber>, "plan.not finite"),
      refused(27, "plan too fast", "3 m/s", plan_once<PlanFault::kTooFast>, "plan.infeasible"),
      refused(27, "plan too tight", "20 rad/s", plan_once<PlanFault::kTooTight>, "plan.infeasible"),
      refused(27, "plan without a stop", "", plan_once<PlanFault::kNoStop>, "plan.no hover"),
      refused(27, "plan that starts 1 m away", "", plan_once<PlanFault::kJumps>,
              "plan.discontinuous"),
      refused(27, "plan out of the fence", "", plan_once<PlanFault::kLeavesFence>,
              "plan.out of fence"),
      refused(27, "plan into an obstacle", "", plan_once<PlanFault::kMeetsObstacle>,
              "plan.obstacle"),
      refused(27, "plan into a teammate", "", plan_once<PlanFault::kMeetsTeammate>,
              "plan.teammate"),
      refused(27, "plan for another vehicle", "", plan_once<PlanFault::kWrongVehicle>,
              "plan.wrong vehicle"),
      refused(27, "empty plan", "everything zero", plan_once<PlanFault::kEmpty>, "plan.stale"),
      {27, "only bad plans from then on", "they leave the fence", "Q1", 0.0,
       plan_always<PlanFault::kLeavesFence>, at_plan_end, "no plan", nullptr, kHold},
      refused(28, "old plan replayed", "three rounds old", plan_once<PlanFault::kReplayed>,
              "plan.stale"),
      {31,
       "head-on at 2 m/s",
       "Q1 and Q2 plan into each other, unseen by the plan check",
       "Q1 Q2",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 2.0) {
           spoil(q1(bench), PlanFault::kHeadOn);
           spoil(q2(bench), PlanFault::kHeadOn);
         }
       },
       {{kHold, 3.5}},
       "separation",
       nullptr,
       kFollow,
       true},
      {31,
       "planner that keeps flying at a teammate",
       "Q2 at Q1, unseen by the plan check",
       "Q2",
       0.0,
       [](FlightBench& bench, double) { spoil(q2(bench), PlanFault::kHeadOn); },
       {{kHold, 3.0}},
       "separation",
       nullptr,
       kHold,
       true},
      {42,
       "map differs",
       "another scenario is announced",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).map_differs = true; },
       {{kHold, kTicks}},
       "map differs",
       nullptr,
       kHold},
  };
}

std::vector<Fault> vehicle_faults() {
  return {
      {29,
       "estimator fails",
       "the autopilot says its estimate is not good",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).estimator_bad = true; },
       {{kHold, 0.2 + kTicks}, {kLand, 1.0 + kTicks}},
       "estimator failed",
       nullptr,
       kIdle},
      {29,
       "estimate 0.5 m off",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).estimate_offset_m = 0.5; },
       {{kHold, 0.1 + kTicks}},
       "estimate off",
       nullptr,
       kHold},
      {29,
       "estimate 1.5 m off",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).estimate_offset_m = 1.5; },
       {{kLand, kTicks}},
       "estimate lost",
       nullptr,
       kIdle},
      {32,
       "gust",
       "3 m/s² for 0.5 s, across",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.5) {
           q1(bench).push_mps2 = {0.0, -3.0, 0.0};
         }
       },
       {},
       nullptr,
       nullptr,
       kFollow},
      {32,
       "pushed aside by a hand",
       "1 m/s for 1 s, along the lane",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 1.0) {
           q1(bench).runaway_mps = {bench.vehicle("Q1").heads_east ? -1.5 : 1.5, 0.0, 0.0};
         }
       },
       {{kHold, 0.8}},
       "tracking",
       nullptr,
       kFollow},
      {33,
       "driven at the fence",
       "1.6 m/s until it holds",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.9 && bench.vehicle("Q1").out.state == kFollow) {
           q1(bench).runaway_mps = {0.0, -1.6, 0.0};
         }
       },
       {{kHold, 0.7}},
       "fence ahead",
       nullptr,
       kFollow},
      {33,
       "driven through the fence",
       "1.4 m/s until 0.05 m before it",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 0.8 && bench.vehicle("Q1").position_m.y() > -1.9) {
           q1(bench).runaway_mps = {0.0, -1.4, 0.0};
         }
       },
       {{kHold, 0.7}, {kLand, 1.0}},
       "fence",
       nullptr,
       kIdle},
      {34,
       "battery critical",
       "10 %",
       "Q1",
       0.0,
       [](FlightBench& bench, double) {
         q1(bench).battery_share = std::min(0.10, q1(bench).battery_share.value_or(1.0));
       },
       {{kLand, 3.5 + kTicks}},
       "battery critical",
       nullptr,
       kIdle},
      {34,
       "battery empty",
       "3 %",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).battery_share = 0.03; },
       {{kLand, 0.5 + kTicks}},
       "battery empty",
       nullptr,
       kIdle},
      {34,
       "voltage sags for 1 s",
       "10 % under load",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (since_s < 1.0) {
           q1(bench).battery_share = std::min(0.10, q1(bench).battery_share.value_or(1.0));
         }
       },
       {},
       nullptr,
       nullptr,
       kFollow},
      {34,
       "battery low",
       "20 %",
       "Q1",
       0.0,
       [](FlightBench& bench, double) {
         q1(bench).battery_share = std::min(0.20, q1(bench).battery_share.value_or(1.0));
       },
       {},
       "battery low",
       nullptr,
       kFollow},
      {34,
       "battery silent",
       "no word of it",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).battery_silent = true; },
       {{kLand, 10.0 + kTicks}},
       "battery silent",
       nullptr,
       kIdle},
      {35,
       "motor lost",
       "the autopilot says so",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).motor_failed = true; },
       {{kKilled, kTicks}},
       "motor",
       nullptr,
       kKilled},
      {35,
       "attitude beyond 60°",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).tilt_rad = 1.3; },
       {{kKilled, 0.1 + kTicks}},
       "tilt",
       nullptr,
       kKilled},
      {35,
       "thrust saturated",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).thrust_saturated = true; },
       {{kLand, 1.0 + kTicks}},
       "thrust saturated",
       nullptr,
       kIdle},
      {37,
       "link cut for 1.2 s",
       "nothing either way",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) { q1(bench).link_cut |= since_s < 1.2; },
       {{kHold, 0.5 + kTicks}},
       "telemetry stale",
       nullptr,
       kFollow},
      {37,
       "link cut for good",
       "nothing either way",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).link_cut = true; },
       {{kHold, 0.5 + kTicks}, {kLand, 3.0 + kTicks}},
       "autopilot lost",
       nullptr,
       kLand},
      {37,
       "telemetry stops",
       "heartbeats go on",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).telemetry_cut = true; },
       {{kHold, 0.5 + kTicks}},
       "telemetry stale",
       nullptr,
       kHold},
      {37,
       "pilot takes over",
       "the autopilot leaves our mode",
       "Q1",
       0.0,
       [](FlightBench& bench, double) { q1(bench).mode_left = true; },
       {{kHold, 0.5 + kTicks}},
       "autopilot disobeys",
       nullptr,
       kHold},
      {45,
       "own process stalls for 40 ms",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) { q1(bench).is_stalled |= since_s < 0.04; },
       {},
       nullptr,
       nullptr,
       kFollow,
       false,
       0.04},
      {45,
       "own process stops for 0.4 s",
       "",
       "Q1",
       0.0,
       [](FlightBench& bench, double since_s) { q1(bench).is_stalled |= since_s < 0.4; },
       {{kHold, 0.4 + kTicks}},
       "own stall",
       "tick.stalls",
       kFollow,
       false,
       0.4},
  };
}

std::vector<Fault> operator_faults() {
  return {
      {17,
       "operator silent for 0.8 s",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) { bench.room().operator_silent |= since_s < 0.8; },
       {},
       nullptr,
       nullptr,
       kFollow},
      {17,
       "operator silent for 2 s",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) { bench.room().operator_silent |= since_s < 2.0; },
       {{kHold, 1.0 + kTicks}},
       "operator quiet",
       nullptr,
       kHold},
      {17,
       "operator station lost",
       "no heartbeat",
       "all",
       0.0,
       [](FlightBench& bench, double) { bench.room().operator_silent = true; },
       {{kHold, 1.0 + kTicks}, {kLand, 3.0 + kTicks}},
       "operator lost",
       nullptr,
       kIdle},
      {17,
       "first station lost, a second beats on",
       "it says follow, too",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().operator_silent = true;
         bench.room().second_station = true;
       },
       {{kHold, 1.0 + kTicks}},
       "operator quiet",
       nullptr,
       kFollow},
      {36,
       "emergency stop",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop twice",
       "0.1 s apart",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0) || is_at(since_s, 0.1)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop while landing",
       "1 s after `land`",
       "all",
       1.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kLand;
         } else if (is_at(since_s, 1.0)) {
           bench.room().says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "emergency stop from a second station",
       "not in charge",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().other_says = OperatorAction::kEmergencyStop;
         }
       },
       {{kKilled, kTicks}},
       "emergency stop",
       nullptr,
       kKilled},
      {36,
       "second station beats beside the first",
       "and says follow and arm",
       "all",
       0.0,
       [](FlightBench& bench, double) {
         bench.room().second_station = bench.room().second_arms = true;
       },
       {},
       nullptr,
       "command.refused",
       kFollow},
      {36,
       "operator says land",
       "",
       "all",
       0.0,
       [](FlightBench& bench, double since_s) {
         if (is_at(since_s, 0.0)) {
           bench.room().says = OperatorAction::kLand;
         }
       },
       {{kLand, kTicks}},
       nullptr,
       nullptr,
       kIdle},
  };
}

// See Fault::needs_quiet.
constexpr const char* kNeedQuiet[] = {
    "head-on at 2 m/s",         "planner that keeps flying at a teammate",
    "pushed aside by a hand",   "driven at the fence",
    "driven through the fence", "estimate 0.5 m off",
    "estimate 1.5 m off",       "stuck while moving",
    "stuck while hovering"};

}  // namespace

const std::vector<Fault>& fault_catalogue() {
  static const std::vector<Fault> kAll = [] {
    std::vector<Fault> all;
    std::vector<Fault> of_plans = plan_faults();
    for (Fault& fault : of_plans) {
      fault.strikes_by_plans = true;
    }
    for (const auto& part : {mocap_faults(), of_plans, vehicle_faults(), operator_faults()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    for (Fault& fault : all) {
      for (const char* name : kNeedQuiet) {
        fault.needs_quiet = fault.needs_quiet || std::string(fault.name) == name;
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Fault& a, const Fault& b) { return a.number < b.number; });
    return all;
  }();
  return kAll;
}

int severity_of(FlightState state) {
  switch (state) {
    case FlightState::kFollow:
      return 0;
    case FlightState::kHold:
      return 1;
    case FlightState::kLand:
    case FlightState::kIdle:
      return 2;
    case FlightState::kKilled:
      return 3;
  }
  return 0;
}

}  // namespace vantage::test
