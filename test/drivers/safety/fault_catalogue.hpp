#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "test/drivers/safety/flight_bench.hpp"

// Table of the faults that flight safety must survive: the fault, the states that must be reached
// and their time limits, and the final state. Numbers are those of the project's list of faults.

namespace vantage::test {

/// Minimum severity that the vehicles must reach within `within_s` after the fault begins.
struct Stage {
  models::FlightState state;
  double within_s;
};

/// Function that sets the knobs at each tick; `since_s` is the time since the fault began.
using Act = std::function<void(FlightBench& bench, double since_s)>;

struct Fault {
  int number;        ///< in the project's list
  const char* name;  ///< of this case
  const char* what;
  const char* whom;  ///< vehicles that must react: "Q1", "Q1 Q2" or "all"
  double begins_s;   ///< s after the injection; for a fault that needs a preparation
  Act act;
  std::vector<Stage> stages;      ///< empty: the vehicle flies on
  const char* reason = nullptr;   ///< condition that must be among the reasons
  const char* counter = nullptr;  ///< must have grown; for inputs refused without a reaction
  models::FlightState end = models::FlightState::kFollow;
  bool trusts_plans = false;  ///< see FlightBench
  double delays_s = 0.0;      ///< s; during this time no other fault can be detected either
  /// It only affects a vehicle that follows and is seen. Together with a fault that changes the
  /// state it may have no effect; then only the violations are checked.
  bool needs_undisturbed_flight = false;
  bool acts_through_plans = false;  ///< a missing or refused plan delays its effect
};

/// Returns all faults, ordered by number.
const std::vector<Fault>& fault_catalogue();

/// Returns 0 for follow, 1 for hold, 2 for landing or landed, 3 for killed.
int severity_of(models::FlightState state);

/// Result of one fault within a run.
struct Outcome {
  bool reacted = false;
  double reaction_s = 0.0;           ///< s until all concerned vehicles show it
  std::vector<double> stage_s;       ///< s until each stage; negative: never
  models::FlightState end{};         ///< least severe state of the concerned vehicles
  std::vector<std::string> reasons;  ///< in the order of appearance
};

struct FaultRun {
  std::vector<Outcome> outcomes;  ///< one per fault
  std::vector<std::string> violations;
  /// Jumps of set-points and returns to less severe states (SetpointMonitor).
  std::vector<std::string> path_violations;
  double closest_m = 0.0;
};

class SetpointMonitor;

/// Time at which faults begin: in the middle of a planning round, with all vehicles on their lanes.
inline constexpr double kBeginS = 6.4;
inline constexpr double kStaggerS = 0.25;
/// Starts the faults on a flying bench, kStaggerS apart, and runs for `lasts_s`. `monitor` (may be
/// null) observes each tick.
FaultRun fly(FlightBench& bench, std::span<const Fault* const> faults, double lasts_s,
             SetpointMonitor* monitor);
/// Flies up, starts the faults kStaggerS apart, and runs for `lasts_s`.
FaultRun fly_with(std::span<const Fault* const> faults, std::uint64_t seed, double lasts_s = 16.0);

}  // namespace vantage::test
