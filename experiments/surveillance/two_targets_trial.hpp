#pragma once

#include <cstdint>
#include <vector>

#include "experiments/surveillance/landmark_watch.hpp"

namespace vantage::experiments {

/// Returns the setting of two quadrotors above two static targets, 4 m apart in a lab of 8 × 4 m,
/// with a sensor range of 1 m. With `jammed_robot` −1, the robot with the more valuable plan is
/// jammed at each planning. The dissertation does not state these parameters. The primitives, the
/// noise, T = 12 and τ = 0.5 s are those of config/lab.yaml. Our choices are: replanning every two
/// steps, uncertainty growth as in a random walk of 0.01 m²/s, a duration of two minutes, and the
/// targets' positions.
/// Source: dissertation, section 4.F.4.
WatchSetting two_targets_setting(int jammed_robot);

/// Returns random starts, determined by `seed`: the first robot in the first target's half of the
/// lab, the second in the other half. The robots fly at 1 m and 2 m height, so they cannot collide.
std::vector<models::Viewpoint> two_targets_starts(const WatchSetting& setting, std::uint64_t seed);

/// Statistics of the visits of one robot to the two targets.
struct Visits {
  int switches = 0;  ///< number of times that the robot came into range of another target
  /// Share of the steps in range of the target nearest to the robot's start, among all steps in
  /// range of a target.
  double home_share = 0.0;
};
/// Counts the visits of `robot` in a run over two targets; jamming is ignored.
Visits visits(const WatchSetting& setting, const WatchRun& run, std::size_t robot);

}  // namespace vantage::experiments
