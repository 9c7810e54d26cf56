#include "drivers/camera/tag_pose.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "drivers/camera/tag_detector.hpp"

// J: derivative of the eight pixel coordinates with respect to the pose (translation, rotation).
// R, t: rotation and translation of camera_from_tag. H: homography from the tag's plane.

namespace vantage::drivers::camera {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector8 = Eigen::Matrix<double, 8, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix86 = Eigen::Matrix<double, 8, 6>;

constexpr int kIterationsMax = 60;
constexpr double kDampingMax = 1e12;
constexpr double kStepMin = 1e-11;          // relative size of the last step
constexpr double kSameTurn_rad = 1e-3;      // rad; rotations within this angle are the same minimum
constexpr double kWeightMin = 1e-3;         // smallest probability of a second pose that matters
constexpr double kDisagreementMax = 11.34;  // 99 % quantile of χ² with three degrees of freedom
constexpr double kBadFitMax = 23.03;  // 1 − 1e-5 quantile of χ² with two degrees of freedom

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0.0, -v.z(), v.y(),  //
      v.z(), 0.0, -v.x(),     //
      -v.y(), v.x(), 0.0;
  return out;
}

struct Residuals {
  Vector8 error_pixels;  // projected minus measured corners
  Matrix86 jacobian;
};

std::optional<Residuals> residuals_at(const models::CameraModel& camera, double half_m,
                                      const Corners& corners, const Eigen::Matrix3d& R,
                                      const Eigen::Vector3d& t) {
  Residuals out;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto corner = static_cast<std::size_t>(i);
    const Eigen::Vector3d turned = R * Eigen::Vector3d(half_m * kTagCorners[corner].x(),
                                                       half_m * kTagCorners[corner].y(), 0.0);
    const auto seen = models::project(camera, turned + t);
    if (!seen) {
      return std::nullopt;
    }
    out.error_pixels.segment<2>(2 * i) = seen->pixel - corners[corner];
    out.jacobian.block<2, 3>(2 * i, 0) = seen->jacobian_per_m;
    out.jacobian.block<2, 3>(2 * i, 3) = -seen->jacobian_per_m * cross_matrix(turned);
  }
  return out;
}

/// Returns the pose of the plane from the homography of the undistorted corners.
std::optional<Pose3> pose_from_homography(const models::CameraModel& camera, double half_m,
                                          const Corners& corners) {
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  Vector8 b;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto corner = static_cast<std::size_t>(i);
    const auto ratio = models::undistort(camera, corners[corner]);
    if (!ratio) {
      return std::nullopt;
    }
    const Eigen::RowVector3d point(half_m * kTagCorners[corner].x(),
                                   half_m * kTagCorners[corner].y(), 1.0);
    A.block<1, 3>(2 * i, 0) = point;
    A.block<1, 3>(2 * i + 1, 3) = point;
    A.block<1, 2>(2 * i, 6) = -ratio->x() * point.head<2>();
    A.block<1, 2>(2 * i + 1, 6) = -ratio->y() * point.head<2>();
    b.segment<2>(2 * i) = *ratio;
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 8, 8>> solver(A);
  if (!solver.isInvertible()) {
    return std::nullopt;
  }
  const Vector8 h = solver.solve(b);
  Eigen::Matrix3d H;
  H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1.0;
  const double scale = 0.5 * (H.col(0).norm() + H.col(1).norm());
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    return std::nullopt;
  }
  H /= scale;
  Eigen::Matrix3d turn;
  turn << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  if (!(R.determinant() > 0.0) || !(H.col(2).z() > 0.0)) {
    return std::nullopt;
  }
  return Pose3{H.col(2), Quaternion(R)};
}

/// Minimises the squared error of the corners from `start` on (Levenberg-Marquardt).
std::optional<TagPose> refine(const models::CameraModel& camera, double half_m,
                              const Corners& corners, const Pose3& start, double sigma_pixels) {
  Eigen::Matrix3d R = start.rotation.toRotationMatrix();
  Eigen::Vector3d t = start.translation_m;
  auto now = residuals_at(camera, half_m, corners, R, t);
  if (!now) {
    return std::nullopt;
  }
  double damping = 1e-3;
  for (int i = 0; i < kIterationsMax && damping < kDampingMax; ++i) {
    const Matrix6 JtJ = now->jacobian.transpose() * now->jacobian;
    Matrix6 damped = JtJ;
    damped.diagonal() += damping * JtJ.diagonal();
    const Vector6 step = -damped.ldlt().solve(now->jacobian.transpose() * now->error_pixels);
    if (!step.allFinite()) {
      return std::nullopt;
    }
    const Eigen::Vector3d turn = step.tail<3>();
    const Eigen::Matrix3d R_next =
        turn.norm() > 0.0 ? Eigen::Matrix3d(Eigen::AngleAxisd(turn.norm(), turn.normalized()) * R)
                          : R;
    const Eigen::Vector3d t_next = t + step.head<3>();
    auto next = residuals_at(camera, half_m, corners, R_next, t_next);
    if (next && next->error_pixels.squaredNorm() <= now->error_pixels.squaredNorm()) {
      R = R_next;
      t = t_next;
      now = std::move(next);
      damping = std::max(1e-12, damping * 0.1);
      if (step.head<3>().norm() < kStepMin * t.norm() && turn.norm() < kStepMin) {
        break;
      }
    } else {
      damping *= 10.0;
    }
  }
  if (!(R.col(2).dot(t) < 0.0)) {
    return std::nullopt;  // the tag would be seen from behind
  }
  const Matrix6 information =
      now->jacobian.transpose() * now->jacobian / (sigma_pixels * sigma_pixels);
  const Eigen::LLT<Matrix6> factor(information);
  if (factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  TagPose out;
  out.camera_from_tag = {t, Quaternion(R).normalized()};
  out.covariance = factor.solve(Matrix6::Identity());
  out.error2_pixels2 = now->error_pixels.squaredNorm();
  return out.covariance.allFinite() ? std::optional(out) : std::nullopt;
}

/// Returns the pose with nearly the same corners, whose plane is tilted to the other side of the
/// line of sight v: R' = (I − 2 v vᵀ) R diag(1, 1, −1).
Pose3 mirrored(const Pose3& pose) {
  const Eigen::Vector3d v = pose.translation_m.normalized();
  const Eigen::Matrix3d R = pose.rotation.toRotationMatrix();
  const Eigen::Matrix3d flipped = (Eigen::Matrix3d::Identity() - 2.0 * v * v.transpose()) * R *
                                  Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
  return {pose.translation_m, Quaternion(flipped)};
}

}  // namespace

std::optional<TagPoses> estimate_poses(const models::CameraModel& camera, double size_m,
                                       const std::array<Eigen::Vector2d, 4>& corners_pixels,
                                       double corner_sigma_pixels) {
  const double half_m = 0.5 * size_m;
  const auto start = pose_from_homography(camera, half_m, corners_pixels);
  if (!start) {
    return std::nullopt;
  }
  std::optional<TagPose> first =
      refine(camera, half_m, corners_pixels, *start, corner_sigma_pixels);
  const Pose3 other = mirrored(first ? first->camera_from_tag : *start);
  std::optional<TagPose> second =
      refine(camera, half_m, corners_pixels, other, corner_sigma_pixels);
  if (!first || (second && second->error2_pixels2 < first->error2_pixels2)) {
    std::swap(first, second);
  }
  if (!first) {
    return std::nullopt;
  }
  const bool is_same = second && first->camera_from_tag.rotation.angularDistance(
                                     second->camera_from_tag.rotation) < kSameTurn_rad;
  return TagPoses{*first, is_same ? std::nullopt : second};
}

bool is_inside(const models::CameraModel& camera,
               const std::array<Eigen::Vector2d, 4>& corners_pixels) {
  constexpr double kBorderMin = 3.0 - 0.5;  // pixels; from the centre of a border pixel
  return std::all_of(corners_pixels.begin(), corners_pixels.end(), [&](const auto& corner) {
    return corner.x() >= kBorderMin && corner.x() <= camera.width - 1 - kBorderMin &&
           corner.y() >= kBorderMin && corner.y() <= camera.height - 1 - kBorderMin;
  });
}

PositionOrFault position_of(const TagPoses& poses, double corner_sigma_pixels) {
  const double variance_pixels2 = corner_sigma_pixels * corner_sigma_pixels;
  if (poses.best.error2_pixels2 / variance_pixels2 > kBadFitMax) {
    return {std::nullopt, PositionFault::kBadFit};
  }
  TagPosition out{poses.best.camera_from_tag.translation_m,
                  poses.best.covariance.topLeftCorner<3, 3>()};
  if (!poses.second) {
    return {out};
  }
  const double excess = poses.second->error2_pixels2 - poses.best.error2_pixels2;
  const double odds = std::exp(-0.5 * excess / variance_pixels2);
  const double weight = odds / (1.0 + odds);
  if (weight < kWeightMin) {
    return {out};
  }
  const Eigen::Matrix3d covariance_m2 = poses.second->covariance.topLeftCorner<3, 3>();
  const Eigen::Vector3d apart_m = poses.second->camera_from_tag.translation_m - out.position_m;
  if (apart_m.dot((out.covariance_m2 + covariance_m2).ldlt().solve(apart_m)) > kDisagreementMax) {
    return {std::nullopt, PositionFault::kAmbiguous};
  }
  // Mean and covariance of the mixture of the two poses.
  out.position_m += weight * apart_m;
  out.covariance_m2 = (1.0 - weight) * out.covariance_m2 + weight * covariance_m2 +
                      weight * (1.0 - weight) * apart_m * apart_m.transpose();
  return {out};
}

}  // namespace vantage::drivers::camera
