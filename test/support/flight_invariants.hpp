#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "test/support/flight_record.hpp"

namespace vantage::test {

/// How far a flight may go from what must hold of each. The defaults are those of a flight to which
/// nothing happens; one whose driver is killed has more than one run, and a longer gap.
struct FlightBounds {
  double follow_share_min = 0.98;
  std::set<std::string> may_hold;  ///< robots of which that share is not asked
  double setpoint_error_rms_max_m = 0.10;
  double speed_max_share = 1.15;
  double turn_max_share = 1.7;  ///< a real ArduCopter overshoots to 1.53, a real PX4 to 1.2
  double outside_max_m = 0.0;
  double setpoint_jump_max_m = 0.1;
  double gap_max_s = 0.5;  ///< of what is said and of what is seen
  int runs_max = 1;
  double held_up_max_s = 0.1;  ///< that a process waits for a processor, of any second
  /// Used by all processes together in that second. If more, they held up themselves.
  double processors_held_up_max = 1.5;
  double processors_max = 1.0;  ///< used by all of them in the mean, so that none spins
  bool is_slowed = false;       ///< all takes longer than in flight: by a sanitizer
};

/// How many processors' worth all processes used together, since anybody followed a plan.
double processors_used(const FlightRecord& record);
/// In a part of that time.
double processors_used(const FlightRecord& record, Time begin, Time end);

/// What the machine did to a flight: which process it kept waiting for longer than allowed, for
/// people; or that all of it was slowed down. nullopt: it was there whenever it was wanted but by
/// the flight's own processes, or the log, an old one, does not say.
std::optional<std::string> held_up(const FlightRecord& record, const FlightBounds& bounds = {});

/// The collisions that are judged, for people: all; where the flight was held_up() those of
/// landings without a pose are not, which are the autopilot's, straight down
/// (docs/explanation/safety.md).
std::vector<std::string> collisions(const FlightRecord& record, const FlightBounds& bounds = {});

/// What did not hold, a line each: `ROBOT INVARIANT: what was seen (what is allowed)`. The
/// invariants, by their names: following, set-point error, speed, turn, separation (nobody nearer
/// than the sum of the two radii), fence (nor landed for it), continuity, ages, believed. Empty:
/// all held. A record without a scenario, or without vehicles, holds nothing. Where the flight was
/// held_up() only what must hold whatever the machine does: that everybody followed at all,
/// separation, the fence, who was believed, and that no process spins (TEAM processors).
std::vector<std::string> violations(const FlightRecord& record, const FlightBounds& bounds = {});

}  // namespace vantage::test
