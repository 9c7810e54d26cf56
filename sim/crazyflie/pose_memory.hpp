#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::sim {

/// Pose estimate of an emulated Crazyflie: the true pose plus an error. An external pose sets the
/// error at once, without a check. Without poses the position drifts and the variance grows, as
/// measured with firmware 2026.08 and a gyroscope bias of 0.1 °/s.
class PoseMemory {
 public:
  /// Processes an external pose; NaN in the position makes the estimate NaN permanently.
  void take(const Eigen::Vector3d& position_world_m, const std::optional<Quaternion>& rotation,
            const Pose3& truth, Time now);
  /// Forgets everything, as the firmware does for the parameter kalman.resetEstimation.
  void reset() { *this = {}; }

  /// Before the first pose, the estimate stays at the origin.
  [[nodiscard]] Pose3 estimate(const Pose3& truth, Time now) const;
  /// Returns the standard deviation of each coordinate, m.
  [[nodiscard]] double sigma_m(Time now) const;
  [[nodiscard]] bool has_pose() const { return newest_.has_value(); }

 private:
  std::optional<Time> newest_;
  Eigen::Vector3d error_m_ = Eigen::Vector3d::Zero();
  /// rotation from the true to the estimated attitude
  Quaternion turned_ = Quaternion::Identity();
};

}  // namespace vantage::sim
