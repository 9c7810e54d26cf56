#include "core/pose.hpp"

#include <cmath>

namespace vantage {
namespace {

// Below these angles a series is used, because its next term is less than the rounding error. The
// form 1 − cos ω is not used because of cancellation.
constexpr double kSmallAngle_rad = 1e-4;
constexpr double kSmallAngleOfCube_rad = 0.03;
constexpr double kVertical = 1e-12;

/// Returns sin ω / ω.
double sinc(double angle_rad) {
  return std::abs(angle_rad) < kSmallAngle_rad ? 1.0 - angle_rad * angle_rad / 6.0
                                               : std::sin(angle_rad) / angle_rad;
}

/// Returns (1 − cos ω) / ω.
double cosc(double angle_rad) { return std::sin(0.5 * angle_rad) * sinc(0.5 * angle_rad); }

/// Returns (ω − sin ω) / ω³.
double sinc3(double angle_rad) {
  const double a2 = angle_rad * angle_rad;
  return std::abs(angle_rad) < kSmallAngleOfCube_rad
             ? (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0)) / 6.0
             : (angle_rad - std::sin(angle_rad)) / (a2 * angle_rad);
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

// Returns V(θ) of SE(3): translation = V ρ. Source: Solà et al. (2018), eq. 174.
Eigen::Matrix3d left_jacobian_so3(const Eigen::Vector3d& theta) {
  const double angle = theta.norm();
  const Eigen::Matrix3d S = skew(theta);
  const double half_sinc = sinc(0.5 * angle);
  return Eigen::Matrix3d::Identity() + 0.5 * half_sinc * half_sinc * S + sinc3(angle) * S * S;
}

}  // namespace

Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const Eigen::Vector2d p = a_from_b * b_from_c.position_m();
  return {p.x(), p.y(), wrap_to_pi(a_from_b.yaw_rad + b_from_c.yaw_rad)};
}

Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& p_b) {
  const double c = std::cos(a_from_b.yaw_rad);
  const double s = std::sin(a_from_b.yaw_rad);
  return {a_from_b.x_m + c * p_b.x() - s * p_b.y(), a_from_b.y_m + s * p_b.x() + c * p_b.y()};
}

Pose2 inverse(const Pose2& a_from_b) {
  const double c = std::cos(a_from_b.yaw_rad);
  const double s = std::sin(a_from_b.yaw_rad);
  return {-c * a_from_b.x_m - s * a_from_b.y_m, s * a_from_b.x_m - c * a_from_b.y_m,
          wrap_to_pi(-a_from_b.yaw_rad)};
}

Pose2 exp_se2(const Eigen::Vector3d& twist) {
  const double w = twist.z();
  const double sin_by = sinc(w);
  const double cos_by = cosc(w);
  return {sin_by * twist.x() - cos_by * twist.y(), cos_by * twist.x() + sin_by * twist.y(),
          wrap_to_pi(w)};
}

Eigen::Vector3d log_se2(const Pose2& a_from_b) {
  const double w = a_from_b.yaw_rad;
  const double sin_by = sinc(w);
  const double cos_by = cosc(w);
  const double det = sin_by * sin_by + cos_by * cos_by;
  return {(sin_by * a_from_b.x_m + cos_by * a_from_b.y_m) / det,
          (-cos_by * a_from_b.x_m + sin_by * a_from_b.y_m) / det, w};
}

Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c) {
  return {a_from_b * b_from_c.translation_m, (a_from_b.rotation * b_from_c.rotation).normalized()};
}

Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& p_b) {
  return a_from_b.translation_m + a_from_b.rotation * p_b;
}

Pose3 inverse(const Pose3& a_from_b) {
  const Quaternion b_from_a = a_from_b.rotation.conjugate();
  return {-(b_from_a * a_from_b.translation_m), b_from_a};
}

Pose3 exp_se3(const Eigen::Matrix<double, 6, 1>& twist) {
  const Eigen::Vector3d theta = twist.tail<3>();
  const double angle = theta.norm();
  Quaternion rotation;
  rotation.w() = std::cos(angle / 2.0);
  rotation.vec() = 0.5 * sinc(0.5 * angle) * theta;
  return {left_jacobian_so3(theta) * twist.head<3>(), rotation.normalized()};
}

Eigen::Matrix<double, 6, 1> log_se3(const Pose3& a_from_b) {
  const Eigen::AngleAxisd turn(a_from_b.rotation);
  double angle = turn.angle();
  if (angle > kPi) {
    angle -= 2.0 * kPi;
  }
  const Eigen::Vector3d theta = angle * turn.axis();
  Eigen::Matrix<double, 6, 1> twist;
  twist.head<3>() = left_jacobian_so3(theta).partialPivLu().solve(a_from_b.translation_m);
  twist.tail<3>() = theta;
  return twist;
}

Pose3 lift(const Pose2& world_from_body, double height_m) {
  return {{world_from_body.x_m, world_from_body.y_m, height_m},
          Quaternion(Eigen::AngleAxisd(world_from_body.yaw_rad, Eigen::Vector3d::UnitZ()))};
}

Pose2 flatten(const Pose3& world_from_body) {
  const Eigen::Vector3d forward = world_from_body.rotation * Eigen::Vector3d::UnitX();
  // If the axis is vertical, its horizontal direction is only rounding error, so 0 is returned.
  const bool is_vertical = forward.head<2>().norm() < kVertical;
  return {world_from_body.translation_m.x(), world_from_body.translation_m.y(),
          is_vertical ? 0.0 : std::atan2(forward.y(), forward.x())};
}

}  // namespace vantage
