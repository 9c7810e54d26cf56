#pragma once

#include <optional>
#include <string>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/onboard_pose.hpp"
#include "models/exchange/pose_messages.hpp"

namespace vantage::drivers {

/// Pose of a vehicle from POSE_R and ODOMETRY_R, which replaces the pose in mocap frames that do
/// not show the vehicle.
class EstimatedPose {
 public:
  /// Largest time from the newest POSE_R to a frame in which it is used.
  static constexpr Duration kAgeMax = std::chrono::milliseconds(400);

  /// @param height_m  height of the body in frames; POSE_R has none
  EstimatedPose(std::string robot, const Pose2& start, double height_m, Time now)
      : robot_(std::move(robot)), height_m_(height_m), pose_(start, now) {}

  void on_pose(const models::PoseEstimate& estimate);
  void on_odometry(const models::OdometryReport& odometry);

  struct Filled {
    models::MocapFrame frame;
    double sigma_m = 0.0;  ///< m; largest 1σ of the horizontal position; > 0
  };
  /// Returns `frame` with the estimated pose. nullopt: motion capture shows the vehicle, or no
  /// recent pose is known.
  [[nodiscard]] std::optional<Filled> fill(const models::MocapFrame& frame) const;

 private:
  std::string robot_;
  double height_m_;
  models::OnboardPose pose_;
  std::optional<models::PoseEstimate> newest_;
};

}  // namespace vantage::drivers
