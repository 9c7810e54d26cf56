#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/sensor/clutter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::experiments {

/// Methods compared in a clutter trial. The last one receives the target id of each detection, and
/// no false alarms.
enum class ClutterMethod { kLabelled, kJpda, kNearest, kKnownIds };
inline constexpr std::array<const char*, 4> kClutterMethods = {"lmb", "jpda", "nearest_neighbour",
                                                               "known_ids"};

/// Results of one method in a trial; means over all steps after the first ten seconds.
struct ClutterScore {
  double ospa_m = 0.0;  ///< OSPA distance of order 2 with cutoff 1 m
  double swaps_per_min = 0.0;
  double matched_rmse_m = 0.0;  ///< RMSE over the best assignment, without a cutoff
  double tracks = 0.0;          ///< number of confirmed tracks
  double step_cpu_s = 0.0;      ///< CPU time of one step with all robots' observations, s
};
using ClutterScores = std::array<ClutterScore, kClutterMethods.size()>;

/// Runs a tracking trial with false alarms. The targets of `scenario` are simulated as driving
/// robots. The sensors are on points that fly at 1 m/s to the target estimate with the largest
/// ratio of position variance to distance. `detection` defines missed detections and false alarms.
/// In each step all methods process the same observations, each with its own central filter. The
/// estimates of the filter with known ids determine the flight of the sensors. The result depends
/// only on the arguments, except for step_cpu_s.
ClutterScores track_in_clutter(const scenario::Scenario& scenario,
                               const models::DetectionModel& detection, double duration_s,
                               std::uint64_t seed);

}  // namespace vantage::experiments
