#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"

namespace vantage::logs {

/// Errors of the robots' own poses (POSE_R) without motion capture, over all robots and messages.
struct PoseMeans {
  std::int64_t samples = 0;           ///< poses that were compared with the truth
  std::int64_t unknown = 0;           ///< messages without a pose
  std::optional<double> rmse_m;       ///< m; horizontal position
  std::optional<double> error_max_m;  ///< m
  std::optional<double> heading_rmse_rad;
  /// Mean NEES of the horizontal position: 2 if the covariances are consistent, more if they are
  /// too small.
  std::optional<double> position_nees;
};

/// Accumulator of PoseMeans. Poses from motion capture are not counted.
class PoseSums {
 public:
  void on_truth(const models::TruthFrame& frame);
  /// Compares the pose with the truth at its time, interpolated between frames. A pose outside the
  /// time of the kept frames is not counted.
  void on_pose(const models::PoseEstimate& estimate);
  [[nodiscard]] PoseMeans means() const;

 private:
  struct Frame {
    Time time{};
    std::map<std::string, Pose2> robots;
  };
  [[nodiscard]] std::optional<Pose2> truth_of(const std::string& robot, Time time) const;

  std::deque<Frame> frames_;  ///< newest last
  std::int64_t samples_ = 0;
  std::int64_t unknown_ = 0;
  double squared_m2_ = 0.0;
  double squared_rad2_ = 0.0;
  double max_m_ = 0.0;
  double nees_ = 0.0;
};

}  // namespace vantage::logs
