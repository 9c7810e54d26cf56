#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "estimator/ranges/range_fit.hpp"
#include "logs/file/log_index.hpp"
#include "tools/log/range_csv.hpp"

namespace vantage::tools {

/// Ranges to beacons with the robot's positions, in the order of time.
struct RangeRecording {
  std::vector<std::string> beacons;  ///< sorted: numeric names by value, then others
  std::vector<double> times_s;       ///< s; time of each range
  std::vector<estimator::TakenRange> ranges;

  // Numbers of rows left out, by reason. Each row counts once.
  std::int64_t not_finite = 0;       ///< rows without a number or a beacon
  std::int64_t doubled = 0;          ///< repetitions of the same time, beacon and range
  std::int64_t outside_poses = 0;    ///< ranges before the first pose or after the last
  std::int64_t in_gaps = 0;          ///< ranges between poses that are too far apart in time
  std::int64_t poses_left_out = 0;   ///< poses that are not finite, or repeat a time
  std::int64_t too_far = 0;          ///< range or position beyond estimator::kRangeBound_m
  std::vector<std::string> too_few;  ///< beacons with fewer than kRangesOfBeaconMin ranges
  std::int64_t of_too_few = 0;       ///< ranges of the beacons in `too_few`
};

/// Reads a table with the columns time, beacon, range.
Table read_ranges(const std::string& path);
/// Reads a table with the columns time, x, y.
Table read_poses(const std::string& path);

/// Assigns the robot's position to each range, by linear interpolation between the pose before and
/// the pose after it. Rows may be in any order.
/// @param gap_max_s  s; poses farther apart in time are not interpolated. nullopt: five times the
///                   median time between poses, and at least 1 s
RangeRecording place_ranges(Table ranges, Table poses, std::optional<double> gap_max_s);

/// Returns the ranges to targets in a log, measured by the range and range-bearing sensors of
/// `robot` (empty: all robots), and the positions from which they were measured.
/// @throws StartupError if the log contains no such robot or sensor.
RangeRecording recording_of(const logs::IndexedLog& log, const std::string& robot);

struct Survey {
  std::string beacon;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};
/// Reads a table with the columns beacon, x, y. @throws StartupError also for a duplicate beacon.
std::vector<Survey> read_survey(const std::string& path);

/// Recording split by time: `fitted` is the first share, `held_back` the rest. Beacons with too few
/// ranges in `fitted` are left out of both.
struct SplitRecording {
  std::vector<std::string> beacons;
  std::vector<estimator::TakenRange> fitted;
  std::vector<estimator::TakenRange> held_back;
};
SplitRecording split(const RangeRecording& recording, double fitted_share);

}  // namespace vantage::tools
