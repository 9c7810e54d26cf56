#include "core/pose.hpp"

#include <cmath>

namespace vantage {
namespace {

constexpr double kVertical = 1e-12;

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
