#include <utility>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test::faults {
namespace {

// s; plans arrive once per second.
constexpr double kRound = 1.0 + kTicks;

Act spoils(PlanFault fault, const char* robot = "Q1") {
  return [fault, robot](FlightBench& bench, double) { corrupt(bench.vehicle(robot).knobs, fault); };
}

}  // namespace

std::vector<Fault> plan_faults() {
  const auto refused = [](int number, const char* name, const char* what, Act act,
                          const char* counter) {
    return fault(number, name, what, std::move(act), flies_on_counting(counter));
  };
  /// Returns a fault that corrupts the plans for one second; all of them must be refused.
  const auto spoilt = [&](int number, const char* name, const char* what, PlanFault how,
                          const char* counter) {
    return refused(number, name, what, lasting(1.0, spoils(how)), counter);
  };
  const std::vector<Stage> at_plan_end = {{kHold, 3.0 + kTicks}};
  return {
      spoilt(14, "late plan after a newer one", "starts 1 s earlier", PlanFault::kHalfASecondOld,
             "plan.stale"),
      fault(15, "planner cut off for 0.7 s", "plans do not arrive",
            lasting(0.7, spoils(PlanFault::kDropped)), flies_on()),
      fault(15, "planner cut off for 5 s, then back", "plans do not arrive",
            lasting(5.0, spoils(PlanFault::kDropped)), ends(kFollow, at_plan_end, "no plan")),
      fault(23, "planner killed", "", sets(&VehicleKnobs::planner_dead, true),
            ends(kHold, at_plan_end, "no plan")),
      fault(24, "stopped planner continues", "a second planner took over from a silent one",
            both(lasting(4.0, spoils(PlanFault::kDropped)),
                 sets(&VehicleKnobs::second_planner, true)),
            ends(kFollow, {{kHold, 4.0}}, "two planners", "plan.no lease")),
      fault(25, "two planners", "a second run plans a hover each round",
            sets(&VehicleKnobs::second_planner, true),
            flies_on_with_reason("two planners", "plan.no lease")),
      refused(26, "one plan after its deadline", "",
              lasting(1.0, sets(&VehicleKnobs::plan_late, true)), nullptr),
      fault(26, "every plan after its deadline", "", sets(&VehicleKnobs::plan_late, true),
            ends(kHold, {{kHold, 2.0 + kRound}}, "planner late")),
      spoilt(27, "plan with NaN", "", PlanFault::kNotANumber, "plan.not finite"),
      spoilt(27, "plan too fast", "3 m/s", PlanFault::kTooFast, "plan.infeasible"),
      spoilt(27, "plan too tight", "20 rad/s", PlanFault::kTooTight, "plan.infeasible"),
      spoilt(27, "plan without a stop", "", PlanFault::kNoStop, "plan.no hover"),
      spoilt(27, "plan that starts 1 m away", "", PlanFault::kJumps, "plan.discontinuous"),
      spoilt(27, "plan that leaves the fence", "", PlanFault::kLeavesFence, "plan.out of fence"),
      spoilt(27, "plan through an obstacle", "", PlanFault::kMeetsObstacle, "plan.obstacle"),
      spoilt(27, "plan through a teammate", "", PlanFault::kMeetsTeammate, "plan.teammate"),
      spoilt(27, "plan for another vehicle", "", PlanFault::kWrongVehicle, "plan.wrong vehicle"),
      spoilt(27, "empty plan", "everything zero", PlanFault::kEmpty, "plan.stale"),
      fault(27, "only bad plans from now on", "they leave the fence",
            spoils(PlanFault::kLeavesFence), ends(kHold, at_plan_end, "no plan")),
      spoilt(28, "old plan replayed", "three rounds old", PlanFault::kReplayed, "plan.stale"),
      on("Q1 Q2",
         with_trusted_plans(
             fault(31, "head-on at 2 m/s",
                   "Q1 and Q2 plan through each other; the plan check is disabled",
                   lasting(2.0, both(spoils(PlanFault::kHeadOn), spoils(PlanFault::kHeadOn, "Q2"))),
                   ends(kFollow, {{kHold, 3.5}}, "separation")))),
      on("Q2", with_trusted_plans(fault(31, "planner that repeatedly plans towards a teammate",
                                        "Q2 towards Q1; the plan check is disabled",
                                        spoils(PlanFault::kHeadOn, "Q2"),
                                        ends(kHold, {{kHold, 4.0}}, "separation")))),
      fault(42, "map differs", "another process announces a different scenario",
            sets(&VehicleKnobs::map_differs, true), ends(kHold, {{kHold, kTicks}}, "map differs")),
  };
}

}  // namespace vantage::test::faults
