#include "wire/vicon/rotation.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace vantage::wire::vicon {
namespace {

constexpr double kRotationErrorMax = 1e-3;

/// Returns the rotation from y-up to z-up axes: 90° about x.
Quaternion quarter_turn() {
  const double half = std::sqrt(0.5);
  return {half, half, 0.0, 0.0};
}

}  // namespace

Quaternion rotation_from_euler_xyz(const Eigen::Vector3d& euler_rad) {
  const Eigen::Vector3d c = (euler_rad / 2.0).array().cos();
  const Eigen::Vector3d s = (euler_rad / 2.0).array().sin();
  return {
      c.x() * c.y() * c.z() - s.x() * s.y() * s.z(), s.x() * c.y() * c.z() + c.x() * s.y() * s.z(),
      c.x() * s.y() * c.z() - s.x() * c.y() * s.z(), c.x() * c.y() * s.z() + s.x() * s.y() * c.z()};
}

Eigen::Vector3d euler_xyz_from_rotation(const Quaternion& world_from_body) {
  const Eigen::Matrix3d R = world_from_body.toRotationMatrix();
  const double a = std::atan2(-R(1, 2), R(2, 2));
  const double b = std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1)));
  // Computes c from Rx(a)ᵀ·R = Ry(b)·Rz(c). Near |b| = π/2, where a is inaccurate, c compensates
  // the error of a.
  const Eigen::RowVector3d left = std::cos(a) * R.row(1) + std::sin(a) * R.row(2);
  return {a, b, std::atan2(left(0), left(1))};
}

std::optional<Quaternion> rotation_from_matrix(const Eigen::Matrix3d& R) {
  if (!R.allFinite()) {  // maxCoeff() may ignore a NaN
    return std::nullopt;
  }
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationErrorMax || R.determinant() < 0.0) {
    return std::nullopt;
  }
  return Quaternion(R).normalized();
}

std::optional<Quaternion> rotation_from_xyzw(double x, double y, double z, double w) {
  const Quaternion q(w, x, y, z);
  if (!(std::abs(q.norm() - 1.0) <= kRotationErrorMax)) {
    return std::nullopt;
  }
  return q.normalized();
}

Pose3 z_up_from_y_up(const Pose3& pose) {
  const Quaternion turn = quarter_turn();
  const Eigen::Vector3d& p = pose.translation_m;
  return {{p.x(), -p.z(), p.y()}, turn * pose.rotation * turn.conjugate()};
}

Pose3 y_up_from_z_up(const Pose3& pose) {
  const Quaternion turn = quarter_turn();
  const Eigen::Vector3d& p = pose.translation_m;
  return {{p.x(), p.z(), -p.y()}, turn.conjugate() * pose.rotation * turn};
}

}  // namespace vantage::wire::vicon
