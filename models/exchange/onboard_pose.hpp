#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/pose_messages.hpp"

namespace vantage::models {

/// Pose that a vehicle without motion capture assumes: the newest POSE_R, moved by the odometry
/// since then.
class OnboardPose {
 public:
  /// @param start  assumed pose until the first POSE_R
  OnboardPose(const Pose2& start, Time time);

  /// Adds the odometry's displacement (forward m, left m, turn rad) since the previous call.
  void move(Time time, const Eigen::Vector3d& displacement);
  /// Corrects the pose by `estimate`, unless the estimate is unknown or older than the stored
  /// motion.
  void correct(const PoseEstimate& estimate);
  /// Returns the pose at `time`, extrapolated with the last motion by at most kExtrapolationMax.
  [[nodiscard]] Pose2 at(Time time) const;
  /// Returns the assumed pose at the time of the last move().
  [[nodiscard]] Pose2 world_from_body() const { return world_from_odom_ * newest().odom_from_body; }

  static constexpr Duration kExtrapolationMax = std::chrono::milliseconds(200);

 private:
  struct Sample {
    Time time = Time::min();
    Pose2 odom_from_body;
  };
  static constexpr std::size_t kSamples = 64;
  [[nodiscard]] const Sample& newest() const { return samples_[newest_]; }

  Pose2 world_from_odom_;
  std::array<Sample, kSamples> samples_;  ///< ring buffer
  std::size_t newest_ = 0;
  Eigen::Vector3d rate_per_s_ = Eigen::Vector3d::Zero();  ///< rate of the last motion
};

}  // namespace vantage::models
