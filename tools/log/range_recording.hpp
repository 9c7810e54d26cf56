#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "estimator/range_fit.hpp"
#include "logs/file/log_index.hpp"
#include "tools/log/range_csv.hpp"

namespace vantage::tools {

/// Ranges to beacons with where they were taken, in the order of time.
struct RangeRecording {
  std::vector<std::string> beacons;  ///< names, numbers in their order before words
  std::vector<double> times_s;       ///< of `ranges`
  std::vector<estimator::TakenRange> ranges;

  // Rows that are not in it, each counted once.
  std::int64_t not_finite = 0;       ///< no number, or no beacon
  std::int64_t doubled = 0;          ///< the same instant, beacon and range a second time
  std::int64_t outside_poses = 0;    ///< before the first pose or after the last
  std::int64_t in_gaps = 0;          ///< between poses too far from each other in time
  std::int64_t poses_left_out = 0;   ///< not finite, or of the instant of one before it
  std::int64_t too_far = 0;          ///< beyond estimator::kRangeBound_m
  std::vector<std::string> too_few;  ///< beacons with fewer than kRangesOfBeaconMin ranges
  std::int64_t of_too_few = 0;       ///< their ranges
};

/// Columns time, beacon, range.
Table read_ranges(const std::string& path);
/// Columns time, x, y.
Table read_poses(const std::string& path);

/// Each range at the place where the robot was then, by a straight line between the pose before and
/// the one after. Rows may be in any order.
/// @param gap_max_s  between poses farther apart in time nothing is guessed; nullopt: five times as
///                   far as they usually are, and at least a second
RangeRecording place_ranges(Table ranges, Table poses, std::optional<double> gap_max_s);

/// Of a log: what the range and range-bearing sensors of its robots (or of `robot` alone) say of
/// targets, with where they looked from. @throws StartupError when there is no such robot or
/// sensor.
RangeRecording recording_of(const logs::IndexedLog& log, const std::string& robot);

struct Survey {
  std::string beacon;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
};
/// Columns beacon, x, y. @throws StartupError also for a beacon that is there twice.
std::vector<Survey> read_survey(const std::string& path);

/// The part of a recording from the first time on or up to `share` of its time; beacons with too
/// few ranges left in `fitted` are left out of both.
struct SplitRecording {
  std::vector<std::string> beacons;
  std::vector<estimator::TakenRange> fitted;
  std::vector<estimator::TakenRange> held_back;
};
SplitRecording split(const RangeRecording& recording, double fitted_share);

}  // namespace vantage::tools
