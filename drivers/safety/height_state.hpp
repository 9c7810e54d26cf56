#pragma once

#include <optional>

namespace vantage::drivers {

/// Heights of a flying vehicle: commanded, and by mocap on the ground.
struct HeightState {
  double command_m = 0.0;          ///< m; commanded height
  double rate_mps = 0.0;           ///< m/s; rate of command_m at the last tick
  double goal_m = 0.0;             ///< m; height at which a climb or descent of command_m ends
  double unmeasured_m = 0.0;       ///< m; estimate while no measurement is available
  std::optional<double> ground_m;  ///< m; last height measured with the motors off
};

}  // namespace vantage::drivers
