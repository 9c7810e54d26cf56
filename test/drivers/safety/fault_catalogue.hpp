#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "test/drivers/safety/flight_bench.hpp"

// Table of the faults that flight safety must survive. An entry gives the fault, the states that
// must be reached with their time limits, and the final state. The fault numbers are those of the
// project's list of faults.

namespace vantage::test {

/// Minimum severity that the vehicles must reach within `within_s` after the fault begins.
struct Stage {
  models::FlightState state;
  double within_s;
};

/// Function that sets the knobs of the bench at each tick; `since_s` is the time since the fault
/// began, s.
using Act = std::function<void(FlightBench& bench, double since_s)>;

struct Fault {
  int number;        ///< number in the project's list of faults
  const char* name;  ///< name of this case
  const char* what;
  const char* vehicles;  ///< vehicles that must react: "Q1", "Q1 Q2" or "all"
  double begins_s;       ///< s; begin after the injection, > 0 if preparation is needed
  Act act;
  std::vector<Stage> stages;      ///< empty: the vehicle flies on
  const char* reason = nullptr;   ///< condition that must be among the reasons
  const char* counter = nullptr;  ///< name of a counter that must have increased
  models::FlightState end = models::FlightState::kFollow;
  bool trusts_plans = false;  ///< see FlightBench
  double delays_s = 0.0;      ///< s; during this time no other fault can be detected either
  /// The fault only affects a vehicle that follows its plan and is seen by mocap. Another fault
  /// that changes the state may suppress the effect; then only the violations are checked.
  bool needs_undisturbed_flight = false;
  bool acts_through_plans = false;  ///< the effect is delayed by a missing or refused plan
};

/// Returns all faults, ordered by number.
const std::vector<Fault>& fault_catalogue();

/// Returns 0 for follow, 1 for hold, 2 for landing or landed, 3 for killed.
int severity_of(models::FlightState state);

/// Result of one fault within a run.
struct Outcome {
  bool reacted = false;
  double reaction_s = 0.0;      ///< s until all affected vehicles show the reaction
  std::vector<double> stage_s;  ///< s until each stage was reached; negative: never
  models::FlightState end{};    ///< minimum severity of the final state over the affected vehicles
  std::vector<std::string> reasons;  ///< in the order of appearance
};

struct FaultRun {
  std::vector<Outcome> outcomes;  ///< one per fault
  std::vector<std::string> violations;
  /// Descriptions of jumps of set-points and of returns to less severe states (SetpointMonitor).
  std::vector<std::string> path_violations;
  double closest_m = 0.0;
};

class SetpointMonitor;

/// s; bench time at which faults begin: in the middle of a planning round, with all vehicles on
/// their lanes.
inline constexpr double kBeginS = 6.4;
inline constexpr double kStaggerS = 0.25;
/// Starts the faults on a flying bench, kStaggerS apart, and runs for `lasts_s`. `monitor` (may be
/// null) observes each tick.
FaultRun fly(FlightBench& bench, std::span<const Fault* const> faults, double lasts_s,
             SetpointMonitor* monitor);
/// Flies up with the given seed, starts the faults kStaggerS apart, and runs for `lasts_s`.
FaultRun fly_with(std::span<const Fault* const> faults, std::uint64_t seed, double lasts_s = 16.0);

}  // namespace vantage::test
