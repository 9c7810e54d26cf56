#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "test/sim/autopilot/hand.hpp"
#include "test/sim/autopilot/recording.hpp"

namespace vantage::test {

/// A fixed sequence from power-up to motors off. What it tells is marked in the recording.
enum class Drill {
  /// Asked to arm without poses, with them until it does, and then told nothing more.
  kArming,
  /// Set-points of one kind and of others, in motion; a turn; a landing.
  kMotion,
  /// In motion set-points stop, or heartbeats, or everything that is sent.
  kSetpointsStop,
  kHeartbeatsStop,
  kEverythingStops,
  /// In hover poses stop.
  kPosesStop,
  /// In hover poses jump to the side, by a little and by much, and stay there.
  kPosesJump,
};

/// A drill as it was recorded: with parameters beside those of config/autopilot.
struct DrillCase {
  std::string name;  ///< of its recording
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  Drill drill = Drill::kArming;
  std::vector<std::pair<std::string, double>> parameters;
};

const std::vector<DrillCase>& drill_cases();
/// @throws std::runtime_error for a name that is none of theirs.
const DrillCase& drill_case(const std::string& name);

/// Plays the drill; a vehicle that does not come into the air ends it, and its recording says so
/// (no mark "hover").
Recording play(const DrillCase& drill, Hand& hand);

}  // namespace vantage::test
