#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "test/sim/autopilot/recording.hpp"
#include "test/sim/autopilot/scripted_station.hpp"

namespace vantage::test {

/// A fixed sequence of commands from power-up to motors off. Each command is marked in the
/// recording.
enum class Drill {
  /// Requests arming without poses, then with poses until the vehicle arms; then sends no commands.
  kArming,
  /// Sends set-points of several kinds in motion, a turn and a landing.
  kMotion,
  /// Stops the set-points, the heartbeats or all messages during motion.
  kSetpointsStop,
  kHeartbeatsStop,
  kEverythingStops,
  /// Stops the poses during hover.
  kPosesStop,
  /// Shifts the poses sideways during hover: by 0.3 m for 5 s, later by 1.5 m until the landing.
  kPosesJump,
};

/// Recorded drill, with parameters in addition to those of config/autopilot.
struct DrillCase {
  std::string name;  ///< name of the recording
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  Drill drill = Drill::kArming;
  std::vector<std::pair<std::string, double>> parameters;
};

const std::vector<DrillCase>& drill_cases();
/// Returns the drill with this name. @throws std::runtime_error for an unknown name.
const DrillCase& drill_case(const std::string& name);

/// Plays the drill and records it. If the vehicle does not take off, the drill ends and the
/// recording has no mark "hover".
Recording play(const DrillCase& drill, ScriptedStation& station);

}  // namespace vantage::test
