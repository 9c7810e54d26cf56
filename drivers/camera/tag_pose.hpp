#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/camera/camera_model.hpp"

// Pose of a square tag from its four corners. Tag frame: x right, y up, z out of the tag.

namespace vantage::drivers::camera {

using PoseCovariance = Eigen::Matrix<double, 6, 6, kUnaligned>;

/// Pose of a tag, with its covariance.
struct TagPose {
  Pose3 camera_from_tag;
  /// Covariance of the translation, m, then of the rotation about the camera's axes, rad.
  PoseCovariance covariance = PoseCovariance::Zero();
  double error2_pixels2 = 0.0;  ///< sum of the squared distances of the corners
};

/// The poses of a tag that explain its corners. Two poses with nearly the same corners exist for a
/// small tag: its plane may be tilted to either side of the line of sight.
struct TagPoses {
  TagPose best;
  std::optional<TagPose> second;  ///< other local minimum of the error; nullopt: none
};

/// Computes the poses from noisy corners by least squares. Nullopt if the corners are not those of
/// a square in front of the camera, seen from its front.
/// @param corners_pixels  in the order of kTagCorners, with independent noise
/// @param corner_sigma_pixels  1σ of each coordinate of a corner
///
/// Covariance: Σ = σ² (JᵀJ)⁻¹ with J = ∂(corners)/∂(pose).
std::optional<TagPoses> estimate_poses(const models::CameraModel& camera, double size_m,
                                       const std::array<Eigen::Vector2d, 4>& corners_pixels,
                                       double corner_sigma_pixels);

/// True if all corners are at least 3 pixels from the border of the image. Nearer corners have
/// larger errors, because the detector sees less of the tag's edges.
bool is_inside(const models::CameraModel& camera,
               const std::array<Eigen::Vector2d, 4>& corners_pixels);

/// Position of a tag's centre in the camera frame.
struct TagPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

enum class PositionFault {
  kAmbiguous,  ///< the two poses are about equally likely, but their positions differ
  kBadFit,     ///< the corners are not those of a square: the tag is partly hidden or blurred
};

/// Position from the poses, or the reason why there is none. If both poses are likely and their
/// positions agree, the covariance contains their difference.
struct PositionOrFault {
  std::optional<TagPosition> position;
  PositionFault fault = PositionFault::kAmbiguous;  ///< meaningless if there is a position
};
PositionOrFault position_of(const TagPoses& poses, double corner_sigma_pixels);

}  // namespace vantage::drivers::camera
