#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "localizer/judge/recording.hpp"
#include "localizer/robot_localizer.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Receives the estimate of robot `robot` (index) at `time`. In hindsight, times do not ascend.
using PoseWatch = std::function<void(std::size_t robot, Time time, const Pose2& world_from_body,
                                     const Eigen::Matrix3d& covariance)>;

/// Options of processing a recording.
struct JudgeOptions {
  bool is_start_known = true;  ///< true: starts are known with 1σ of 0.01 m and 0.01 rad
  double loss = 0.0;           ///< probability that a receiver misses a message
  std::uint64_t seed = 1;      ///< seed of the random message losses
  int message_every = 2;       ///< steps of 0.1 s between the messages of a robot
  /// s; an estimate for t uses data up to t + hindsight_s. 0: one localiser per robot; the
  /// localisers exchange messages. Above 0: one joint filter, without messages. Infinity: all data
  /// are used.
  double hindsight_s = 0.0;
  PoseWatch watch = {};  ///< receives all judged estimates; may be empty
  /// True positions of the landmarks whose positions the specification does not contain. If there
  /// are any, the estimates are judged after a common rotation and translation that fits the
  /// robots' positions best.
  std::vector<scenario::LandmarkSpec> hidden_landmarks = {};
};

/// Statistics of errors.
struct ErrorFigures {
  int count = 0;
  double rmse = 0.0;
  double median = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

/// Results of one recording, judged at every 0.1 s.
struct JudgeFigures {
  ErrorFigures position_m;  ///< errors of all robots
  std::vector<ErrorFigures> robot_position_m;
  ErrorFigures yaw_rad;        ///< heading errors of the robots with trusted true heading
  double nees_position = 0.0;  ///< mean NEES of the positions; ideal: 2
  double nees_pose = 0.0;      ///< mean NEES of the poses of robots with trusted heading; ideal: 3
  double inside_position = 0.0;              ///< share of positions inside their 95 % ellipse
  double inside_pose = 0.0;                  ///< share of poses inside their 95 % ellipsoid
  std::vector<double> placed_after_s;        ///< s; time until each robot had a pose; −1: never
  std::vector<Eigen::Vector2d> landmarks_m;  ///< positions of found hidden landmarks, not aligned
  double landmarks_rmse_m = 0.0;      ///< m; error of landmarks_m, aligned by the robots' paths
  double landmarks_own_rmse_m = 0.0;  ///< m; error of landmarks_m, aligned by the landmarks
  int without_pose = 0;               ///< instants at which a judged robot had no pose
  double bytes_per_robot_s = 0.0;     ///< rate of the messages, without transport headers
  FilterCounts filter;                ///< counts of the first robot's filter
  InputCounts inputs;                 ///< counts of the first robot's inputs
};

/// Runs the localisers on `recording`.
///
/// The span begins at the latest first odometry stamp, rounded up to 0.1 s, and ends at the
/// earliest last one. An estimate for time t uses only data stamped ≤ t + hindsight_s. With an
/// unknown start, the first 60 s are not judged.
/// @param heading_trusted  per robot: true if its true heading is accurate; empty: all
JudgeFigures judge(const scenario::LocalizerSpec& spec, const Recording& recording,
                   const JudgeOptions& options, const std::vector<bool>& heading_trusted = {});

/// Returns the paths of all robots, estimated from all data in hindsight with unknown starts. A
/// path begins when the robot's start is found; it is empty if the start is never found. Needs no
/// true poses.
std::vector<TruePath> smoothed_paths(const scenario::LocalizerSpec& spec,
                                     const Recording& recording);

}  // namespace vantage::localizer
