#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "test/support/flight_record.hpp"

namespace vantage::test {

/// Bounds of the flight invariants. The defaults are for a flight without disturbances; a flight
/// with a killed driver has more than one run and a longer gap.
struct FlightBounds {
  double follow_share_min = 0.98;
  std::set<std::string> may_hold;  ///< robots without a minimum follow share
  double setpoint_error_rms_max_m = 0.10;
  double speed_max_share = 1.15;
  double turn_max_share = 1.7;  ///< ArduCopter overshoots to 1.53, PX4 to 1.2
  double outside_max_m = 0.0;
  double setpoint_jump_max_m = 0.1;
  double gap_max_s = 0.5;  ///< s; gap between status messages or TRUTH frames
  int runs_max = 1;
  double held_up_max_s = 0.1;  ///< s; longest wait of a process for a processor in any second
  /// Processors used by all processes together in the second of a wait; above this number, the
  /// flight's own processes caused the wait.
  double processors_held_up_max = 1.5;
  double processors_max = 1.0;  ///< mean number used; a process in a busy loop exceeds it
  bool is_slowed = false;       ///< a sanitizer slows all processes down
};

/// Returns the mean number of processors that all processes used since the first followed plan.
double processors_used(const FlightRecord& record);
/// Returns the mean number of processors that all processes used from `begin` to `end`.
double processors_used(const FlightRecord& record, Time begin, Time end);

/// Returns how an overloaded host delayed the flight, as text for people: which process waited
/// longer than allowed, or that a sanitizer slows everything down. Returns nullopt if only the
/// flight's own processes caused waits, or if the log (an old one) lacks the counters.
std::optional<std::string> held_up(const FlightRecord& record, const FlightBounds& bounds = {});

/// Returns the collisions that count, as text for people. In a flight for which held_up() returns a
/// reason, collisions in landings without a pose are omitted, because the autopilot then lands
/// straight down (docs/explanation/safety.md).
std::vector<std::string> collisions(const FlightRecord& record, const FlightBounds& bounds = {});

/// Returns the violations, one line each: `ROBOT INVARIANT: observed (allowed)`. The invariants
/// are: following, set-point error, speed, turn, separation (at least the sum of the two radii),
/// fence (outside, or landed because of the fence), continuity, ages, believed (messages of other
/// programs accepted). Empty if there are none; a record without a scenario or vehicles is one
/// violation. A flight for which held_up() returns a reason is judged only by rules that the host
/// cannot affect: each vehicle has followed a plan, separation, fence, believed, and the processor
/// use of all processes (TEAM processors).
std::vector<std::string> violations(const FlightRecord& record, const FlightBounds& bounds = {});

}  // namespace vantage::test
