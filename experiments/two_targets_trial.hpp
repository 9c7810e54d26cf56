#pragma once

#include <cstdint>
#include <vector>

#include "experiments/landmark_watch.hpp"

namespace vantage::experiments {

/// Two quadrotors over two targets that stand still, 4 m apart in a lab of 8 × 4 m, sensing 1 m
/// around themselves. `jammed_robot` −1: at each planning the one whose plan would bring more.
/// What the text leaves open is the lab's (config/lab.yaml): primitives, noise, T = 12, τ = 0.5 s,
/// planned anew every two steps; that what is known of a target fades as of a random walk of
/// 0.01 m²/s; two minutes; the targets' places.
/// Source: dissertation 4 F.4.
WatchSetting two_targets_setting(int jammed_robot);

/// The first robot anywhere in the first target's half of the lab, the second in the other; 1 m and
/// 2 m high, so that they cannot meet. By `seed` alone.
std::vector<models::Viewpoint> two_targets_starts(const WatchSetting& setting, std::uint64_t seed);

/// Which targets a robot goes to.
struct Visits {
  int switches = 0;         ///< times it came into range of another target than the last
  double home_share = 0.0;  ///< of its steps in range of any, those of its start's nearest target
};
/// Of `robot` in a run over two targets; being jammed does not matter.
Visits visits(const WatchSetting& setting, const WatchRun& run, std::size_t robot);

}  // namespace vantage::experiments
