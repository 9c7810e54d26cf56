#include "sim/crazyflie/flight_control.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace vantage::sim {
namespace {

constexpr double kGravityMps2 = 9.81;
constexpr double kPositionGain = 9.0;  // 1/s²
constexpr double kVelocityGain = 5.0;  // 1/s
constexpr double kIntegralGain = 3.0;  // 1/s³
constexpr double kIntegralMaxMs = 0.3;
constexpr double kLevelMaxMps2 = 4.0;  // horizontal acceleration at a tilt of 22°
constexpr double kAttitudeGain = 280.0;
constexpr double kRateGain = 26.0;
constexpr double kYawGain = 20.0;
constexpr double kYawRateGain = 8.0;
constexpr double kYawTorqueMaxNm = 2e-4;

Eigen::Vector3d vee(const Eigen::Matrix3d& m) { return {m(2, 1), m(0, 2), m(1, 0)}; }

/// Returns the throttle that gives `thrust_n` in the steady state.
double throttle_for(double thrust_n, const MultirotorParameters& body) {
  const double share = std::clamp(thrust_n / body.motor_thrust_max_n, 0.0, 1.0);
  const double linear = 1.0 - body.thrust_expo;
  return (-linear + std::sqrt(linear * linear + 4.0 * body.thrust_expo * share)) /
         (2.0 * body.thrust_expo);
}

}  // namespace

Throttles FlightControl::step(const ControlGoal& goal, bool uses_motion,
                              const Pose3& world_from_body,
                              const Eigen::Vector3d& velocity_world_mps,
                              const Eigen::Vector3d& rate_body_radps, double dt_s) {
  const Eigen::Vector3d off_m = goal.position_world_m - world_from_body.translation_m;
  if (!off_m.allFinite() || !velocity_world_mps.allFinite()) {
    return {};
  }
  integral_ms_ += dt_s * off_m.cwiseMax(-0.3).cwiseMin(0.3);
  integral_ms_ = integral_ms_.cwiseMax(-kIntegralMaxMs).cwiseMin(kIntegralMaxMs);
  const Eigen::Vector3d moved_mps =
      (uses_motion ? goal.velocity_world_mps : Eigen::Vector3d::Zero()) - velocity_world_mps;
  Eigen::Vector3d wanted_mps2 = kPositionGain * off_m.cwiseMax(-1.0).cwiseMin(1.0) +
                                kVelocityGain * moved_mps + kIntegralGain * integral_ms_;
  if (uses_motion) {
    wanted_mps2 += goal.acceleration_world_mps2;
  }
  if (goal.is_level) {
    wanted_mps2.head<2>().setZero();
  }
  const double level_mps2 = wanted_mps2.head<2>().norm();
  if (level_mps2 > kLevelMaxMps2) {
    wanted_mps2.head<2>() *= kLevelMaxMps2 / level_mps2;
  }
  wanted_mps2.z() = std::max(wanted_mps2.z() + kGravityMps2, 0.2 * kGravityMps2);

  const Eigen::Matrix3d r = world_from_body.rotation.toRotationMatrix();
  const double force_n = body_.mass_kg * wanted_mps2.dot(r.col(2));
  Eigen::Matrix3d wanted;
  wanted.col(2) = wanted_mps2.normalized();
  const Eigen::Vector3d ahead(std::cos(goal.yaw_rad), std::sin(goal.yaw_rad), 0.0);
  wanted.col(1) = wanted.col(2).cross(ahead).normalized();
  wanted.col(0) = wanted.col(1).cross(wanted.col(2));
  const Eigen::Vector3d turned = 0.5 * vee(wanted.transpose() * r - r.transpose() * wanted);
  const Eigen::Vector3d gain(kAttitudeGain, kAttitudeGain, kYawGain);
  const Eigen::Vector3d rate_gain(kRateGain, kRateGain, kYawRateGain);
  Eigen::Vector3d torque_nm = body_.inertia_kgm2.cwiseProduct(
      -gain.cwiseProduct(turned) - rate_gain.cwiseProduct(rate_body_radps));
  torque_nm.z() = std::clamp(torque_nm.z(), -kYawTorqueMaxNm, kYawTorqueMaxNm);

  // In the order of Throttles: front right, rear left, front left, rear right.
  constexpr std::array<std::array<double, 3>, kMotors> kSigns{
      {{-1.0, -1.0, -1.0}, {1.0, 1.0, -1.0}, {1.0, -1.0, 1.0}, {-1.0, 1.0, 1.0}}};
  Throttles out{};
  for (std::size_t i = 0; i < kMotors; ++i) {
    const double thrust_n = 0.25 * (force_n + kSigns[i][0] * torque_nm.x() / body_.arm_y_m +
                                    kSigns[i][1] * torque_nm.y() / body_.arm_x_m +
                                    kSigns[i][2] * torque_nm.z() / body_.torque_per_thrust_m);
    out[i] = throttle_for(thrust_n, body_);
  }
  return out;
}

}  // namespace vantage::sim
