#pragma once

#include <array>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// A pose with its covariance of (x, y, yaw).
struct PoseBelief {
  Pose2 world_from_body;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// Finds the pose of a robot with an unknown start, from its own odometry and sightings of
/// landmarks.
///
/// The search collects sightings as points in the frame of the robot's odometry. Each pair of the
/// newest sighting and another landmark's sighting gives one hypothesis of the odometry frame's
/// pose in the world. The hypothesis with the most agreeing sightings is fitted to these. Sightings
/// with a wrong id or a large error therefore do not disturb the result. No function allocates
/// memory.
class StartSearch {
 public:
  static constexpr int kSightingsMax = 64;

  /// Adds the displacement (forward m, left m, turn rad) of `duration_s`.
  void advance(double duration_s, const Eigen::Vector3d& increment);
  /// Adds the sightings of landmarks of one frame at the current time. Returns the robot's pose if
  /// the sightings determine it.
  std::optional<PoseBelief> observe(const scenario::LocalizerSpec& spec, int robot,
                                    std::span<const models::Sighting> sightings);
  /// Forgets all sightings.
  void clear();

 private:
  struct Anchor {
    double at_s = 0.0;
    int id = 0;
    Eigen::Vector2d point_odom_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d point_world_m = Eigen::Vector2d::Zero();
    double sigma_m = 0.0;
  };
  [[nodiscard]] double sigma_m(const Anchor& anchor) const;
  [[nodiscard]] int agreeing(const Pose2& world_from_odom) const;
  [[nodiscard]] std::optional<PoseBelief> fit(const Pose2& world_from_odom) const;

  double now_s_ = 0.0;
  Pose2 odom_from_body_;
  std::array<Anchor, kSightingsMax> anchors_;
  int count_ = 0;
  int next_ = 0;
};

}  // namespace vantage::localizer
