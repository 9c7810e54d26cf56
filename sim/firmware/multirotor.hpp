#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/pose.hpp"

namespace vantage::sim {

inline constexpr std::size_t kMotors = 4;
/// Motor throttles in [0, 1], in the order of both firmwares' quad X: front right, rear left (both
/// turn counter-clockwise seen from above), front left, rear right (clockwise).
using Throttles = std::array<double, kMotors>;

/// Parameters of a quadrotor of about 1 kg with 10 cm propellers and four feet.
struct MultirotorParameters {
  double mass_kg = 1.0;
  double arm_x_m = 0.12;  ///< m; from the centre to a motor, forward
  double arm_y_m = 0.12;  ///< m; from the centre to a motor, sideways
  Eigen::Vector3d inertia_kgm2{0.006, 0.006, 0.010};
  double motor_thrust_max_n = 6.0;
  double motor_lag_s = 0.035;  ///< s; first-order lag of the thrust
  /// e in thrust = T_max (e u² + (1 − e) u), with throttle u.
  double thrust_expo = 0.65;
  double torque_per_thrust_m = 0.016;  ///< m; ratio of yaw torque to thrust of one propeller
  double drag_per_s = 0.25;            ///< 1/s; deceleration per speed through the air
  double spin_drag_nms = 0.002;        ///< N·m·s; torque per angular velocity
  // Ground contact: a spring with friction under each foot. Height 0 is the height of the centre
  // when the vehicle stands on the ground.
  double foot_m = 0.12;  ///< m; distance of a foot from the centre along each horizontal axis
  double foot_stiffness_npm = 2500.0;
  double foot_damping_nspm = 40.0;
  double friction = 0.7;
  // Parameters of the air.
  Eigen::Vector3d wind_world_mps = Eigen::Vector3d::Zero();
  double gust_sigma_mps = 0.1;  ///< m/s; 1σ on each horizontal axis; vertical: a third of this
  double gust_memory_s = 2.0;
  // Parameters of the battery.
  double battery_endurance_s = 900.0;  ///< s; hover time from full to empty
  double battery_full_v = 12.6;
  double battery_empty_v = 10.5;
  double battery_sag_v = 0.8;     ///< V; voltage drop at hover thrust
  double battery_hover_a = 12.0;  ///< A; current while hovering
};

/// Quadrotor as a rigid body with six degrees of freedom, four motors, wind and ground contact.
///
///   m v̇ = Σ T_i R e_z − m g e_z − m d (v − w) + feet,
///   J ω̇ = τ − ω × J ω,   Ṫ_i = (T(u_i) − T_i)/T_m
///
/// World z up, body x forward, y left, z up. The integration is semi-implicit, and deterministic
/// for a seed.
class Multirotor {
 public:
  static constexpr double kStepMaxS = 0.0005;

  /// Places the quadrotor on the ground at `start` with the motors off.
  Multirotor(const MultirotorParameters& parameters, std::uint64_t seed, const Pose2& start);

  /// Steps by `dt_s` in substeps of at most kStepMaxS. Throttles outside [0, 1] are clamped.
  void step(const Throttles& throttles, double dt_s);

  [[nodiscard]] const Pose3& world_from_body() const { return world_from_body_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_mps_; }
  [[nodiscard]] const Eigen::Vector3d& rate_body_radps() const { return rate_radps_; }
  /// Returns the specific force at the centre in the body frame: (0, 0, g) if stationary and level.
  [[nodiscard]] const Eigen::Vector3d& specific_force_body_mps2() const { return force_mps2_; }
  [[nodiscard]] bool is_on_ground() const { return is_on_ground_; }
  [[nodiscard]] double battery_share() const { return battery_share_; }
  [[nodiscard]] double battery_v() const;
  [[nodiscard]] double battery_a() const;

 private:
  void substep(const Throttles& throttles, double dt_s);
  void step_gusts(double dt_s);
  void add_ground_forces(Eigen::Vector3d& force_n, Eigen::Vector3d& torque_body_nm);
  [[nodiscard]] double thrust_n() const;

  MultirotorParameters parameters_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  Pose3 world_from_body_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_radps_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_mps2_;
  Throttles thrusts_n_{};
  Eigen::Vector3d gust_mps_ = Eigen::Vector3d::Zero();
  struct Foot {
    bool is_down = false;
    Eigen::Vector2d anchor_m = Eigen::Vector2d::Zero();  ///< m; contact point, held by friction
  };
  std::array<Foot, 4> feet_;
  bool is_on_ground_ = true;
  double battery_share_ = 1.0;
};

}  // namespace vantage::sim
