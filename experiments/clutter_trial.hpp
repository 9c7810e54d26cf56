#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "models/sensor/clutter.hpp"
#include "scenario/scenario.hpp"

namespace vantage::experiments {

/// Who is judged in a clutter trial. The last knows which target each detection is of, and which
/// are false.
enum class ClutterMethod { kLabelled, kJpda, kNearest, kKnownIds };
inline constexpr std::array<const char*, 4> kClutterMethods = {"lmb", "jpda", "nearest_neighbour",
                                                               "known_ids"};

/// What one method made of a trial; means over its instants but the first ten seconds.
struct ClutterScore {
  double ospa_m = 0.0;  ///< order 2, cutoff 1 m
  double swaps_per_min = 0.0;
  double matched_rmse_m = 0.0;  ///< over the best assignment, whatever the distance
  double tracks = 0.0;          ///< that it tells of
  double step_cpu_s = 0.0;      ///< of an instant with the looks of all robots
};
using ClutterScores = std::array<ClutterScore, kClutterMethods.size()>;

/// The targets of `scenario` as they really drive, and its sensors on points that fly at 1 m/s to
/// where a target is believed that is known least for its distance. What each sees every step,
/// thinned and with false alarms by `detection`, all methods are told in full: one central filter
/// each, on the same looks. Where the sensors fly is decided by the beliefs of known ids.
/// A pure function of its arguments but for step_cpu_s.
ClutterScores track_in_clutter(const scenario::Scenario& scenario,
                               const models::DetectionModel& detection, double duration_s,
                               std::uint64_t seed);

}  // namespace vantage::experiments
