#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "test/drivers/safety/flight_bench.hpp"

// The faults that flight safety must survive, as a table: what is done, how soon which state must
// be reached, and where it ends. Numbers are those of the project's list of faults.

namespace vantage::test {

/// Not later than `within_s` after the fault begins the vehicles are at least this severe.
struct Stage {
  models::FlightState state;
  double within_s;
};

/// Sets knobs, afresh at each tick, `since_s` after the fault began.
using Act = std::function<void(FlightBench& bench, double since_s)>;

struct Fault {
  int number;        ///< on the list
  const char* name;  ///< of this case
  const char* what;
  const char* whom;  ///< vehicles that must react: "Q1", "Q1 Q2" or "all"
  double begins_s;   ///< after the injection, when something has to come first
  Act act;
  std::vector<Stage> stages;      ///< empty: it flies on
  const char* reason = nullptr;   ///< condition that must be among the reasons
  const char* counter = nullptr;  ///< that must have grown, of what is refused and flown through
  models::FlightState end = models::FlightState::kFollow;
  bool trusts_plans = false;  ///< see FlightBench
  double delays_s = 0.0;      ///< for so long nothing else can be noticed either
  /// It only strikes who flies on and is seen. Beside a fault that changes the state it may find
  /// nothing to strike; then only what must never happen is asked.
  bool needs_quiet = false;
  bool strikes_by_plans = false;  ///< a plan that does not come, or is refused, delays it
};

/// All of them, by number.
const std::vector<Fault>& fault_catalogue();

/// Follow 0, hold 1, on the way down or landed 2, killed 3.
int severity_of(models::FlightState state);

/// What came of one fault within a run.
struct Outcome {
  bool reacted = false;
  double reaction_s = 0.0;      ///< until the reason showed, or the counter grew, on all concerned
  std::vector<double> stage_s;  ///< until each stage; negative: never
  models::FlightState end{};    ///< least severe of the vehicles concerned
  std::vector<std::string> reasons;  ///< seen, in order
};

struct FaultRun {
  std::vector<Outcome> outcomes;  ///< one for each fault
  std::vector<std::string> violations;
  /// Of the way: set-points that jumped, states that went back (WayWatch).
  std::vector<std::string> missteps;
  double closest_m = 0.0;
};

class WayWatch;

/// When faults begin: in the middle of a planning round, all vehicles on their lanes.
inline constexpr double kBeginS = 6.4;
inline constexpr double kStaggerS = 0.25;
/// Begins the faults one after the other, kStaggerS apart, on a bench that flies, and goes on for
/// `lasts_s`. `way` (may be null) sees each tick.
FaultRun fly(FlightBench& bench, std::span<const Fault* const> faults, double lasts_s,
             WayWatch* way);
/// Flies up, begins the faults one after the other, kStaggerS apart, and goes on for `lasts_s`.
FaultRun fly_with(std::span<const Fault* const> faults, std::uint64_t seed, double lasts_s = 16.0);

}  // namespace vantage::test
