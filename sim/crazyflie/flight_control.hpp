#pragma once

#include <Eigen/Core>

#include "core/pose.hpp"
#include "sim/firmware/multirotor.hpp"

namespace vantage::sim {

/// Motion that the controller of an emulated Crazyflie tracks.
struct ControlGoal {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_world_mps2 = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  bool is_level = false;  ///< true: keeps attitude level and height, ignores position
};

/// Position and attitude controller of an emulated Crazyflie: a geometric controller on SE(3).
///
///   f = m (a + K_p (p − p̂) + K_d (v − v̂) + K_i ∫(p − p̂) + g e_z),  τ = J (−K_R e_R − K_ω ω)
class FlightControl {
 public:
  explicit FlightControl(const MultirotorParameters& body) : body_(body) {}

  /// Returns the throttles for the next `dt_s`. If the estimate is not finite, they are zero.
  /// @param uses_motion  true: velocity and acceleration of the goal are fed forward, as the
  ///                     Mellinger controller does; false: ignored, as by the PID controller
  Throttles step(const ControlGoal& goal, bool uses_motion, const Pose3& world_from_body,
                 const Eigen::Vector3d& velocity_world_mps, const Eigen::Vector3d& rate_body_radps,
                 double dt_s);
  /// Forgets the integral; call it while the motors are off.
  void reset() { integral_ms_.setZero(); }

 private:
  MultirotorParameters body_;
  Eigen::Vector3d integral_ms_ = Eigen::Vector3d::Zero();  ///< m·s
};

}  // namespace vantage::sim
