#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "test/sim/autopilot/recording.hpp"
#include "test/sim/autopilot/scripted_station.hpp"

namespace vantage::test {

/// A fixed sequence from power-up to motors off. Each command is marked in the recording.
enum class Drill {
  /// Arming without poses, then with poses until it arms, then no further commands.
  kArming,
  /// Set-points of several kinds in motion, a turn, a landing.
  kMotion,
  /// In motion, set-points, heartbeats or all messages stop.
  kSetpointsStop,
  kHeartbeatsStop,
  kEverythingStops,
  /// In hover, poses stop.
  kPosesStop,
  /// In hover, poses jump to the side by a short and a long distance and stay there.
  kPosesJump,
};

/// Recorded drill, with parameters in addition to those of config/autopilot.
struct DrillCase {
  std::string name;  ///< name of its recording
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  Drill drill = Drill::kArming;
  std::vector<std::pair<std::string, double>> parameters;
};

const std::vector<DrillCase>& drill_cases();
/// Returns the drill of that name. @throws std::runtime_error for an unknown name.
const DrillCase& drill_case(const std::string& name);

/// Plays the drill. It ends if the vehicle does not take off; the recording then has no mark
/// "hover".
Recording play(const DrillCase& drill, ScriptedStation& station);

}  // namespace vantage::test
