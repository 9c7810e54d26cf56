#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {
namespace {

// Plans come once a second.
constexpr double kRound = 1.0 + kTicks;

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

}  // namespace

std::vector<Fault> of_plans() {
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
       {{kHold, 4.0}},
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

}  // namespace vantage::test::faults
