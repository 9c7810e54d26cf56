#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/sensor/clutter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::experiments {

/// Methods compared in a clutter trial. The last one is given the target id of each detection, and
/// no false alarms.
enum class ClutterMethod { kLabelled, kJpda, kNearest, kKnownIds };
inline constexpr std::array<const char*, 4> kClutterMethods = {"lmb", "jpda", "nearest_neighbour",
                                                               "known_ids"};

/// Results of one method in a trial; means over all instants after the first ten seconds.
struct ClutterScore {
  double ospa_m = 0.0;  ///< order 2, cutoff 1 m
  double swaps_per_min = 0.0;
  double matched_rmse_m = 0.0;  ///< over the best assignment, without a cutoff
  double tracks = 0.0;          ///< number of confirmed tracks
  double step_cpu_s = 0.0;      ///< s; of one instant with all robots' observations
};
using ClutterScores = std::array<ClutterScore, kClutterMethods.size()>;

/// Runs a tracking trial with false alarms. The targets of `scenario` are simulated as driving
/// robots. The sensors are carried by points that fly at 1 m/s to the target estimate with the
/// largest position variance for its distance. Every step their observations, thinned and with
/// false alarms by `detection`, go to all methods: one central filter each, on the same
/// observations. The filter with known ids decides the flight of the sensors. A pure function of
/// its arguments except for step_cpu_s.
ClutterScores track_in_clutter(const scenario::Scenario& scenario,
                               const models::DetectionModel& detection, double duration_s,
                               std::uint64_t seed);

}  // namespace vantage::experiments
