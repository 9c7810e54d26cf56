#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "sim/quadrotor/course.hpp"
#include "sim/vehicle.hpp"

namespace vantage::sim {

/// Dynamics of a simulated quadrotor. The planner does not know these values.
struct QuadrotorParameters {
  double velocity_lag_s = 0.15;
  double acceleration_max_mps2 = 10.0;  ///< m/s², horizontal; a tilt of 45°
  double yaw_rate_lag_s = 0.08;
  double yaw_acceleration_max_radps2 = 60.0;
  double climb_max_mps = 0.5;
  double position_gain_per_s = 2.0;
  double yaw_gain_per_s = 4.0;
  double height_gain_per_s = 2.0;
  double corner_window_s = 0.12;  ///< s; the controller averages the reference over ± this time
  double command_reserve = 1.3;   ///< ratio of the command limits to the vehicle's limits
  /// m/s²; mean acceleration by the wind
  Eigen::Vector2d wind_mean_mps2 = Eigen::Vector2d::Zero();
  double wind_sigma_mps2 = 0.15;  ///< m/s²; 1σ per axis of the gusts' acceleration, limited to 3σ
  double wind_memory_s = 2.0;
  double endurance_s = 1200.0;  ///< s; flight time from a full to an empty battery
};

/// Returns the parameters of a vehicle in `wind`. The drag acts as an acceleration. Without a wind
/// specification, the default light gusts apply.
QuadrotorParameters parameters_in(const std::optional<scenario::WindSpec>& wind);

/// Result of offering a plan to a vehicle.
enum class [[nodiscard]] PlanVerdict{
    kAccepted,
    kNotFinite,      ///< a number is not finite, or a duration or deceleration is invalid
    kDiscontinuous,  ///< starts too far from the vehicle's course
    kStale,          ///< older than the last accepted plan
    kNotFollowing,   ///< the vehicle's state is not kFollow (hold, land, idle, killed)
};

/// Returns the state after an operator's command. The more severe state applies and latches: follow
/// → hold → land → killed. kFollow ends a hold, and kArm on the ground ends an emergency stop. A
/// landing ends on the ground in the state idle. An idle vehicle takes off into a hold.
models::FlightState after_command(models::FlightState state, models::OperatorAction action,
                                  bool on_ground);

/// One flying vehicle: a velocity-controlled multirotor with first-order lags and wind, and the
/// controller that makes it follow plans.
///
///   v̇ = (v_cmd − v)/T_v + wind,  ω̇ = (ω_cmd − ω)/T_ω,
///   v_cmd = v_s + T_v a_s + k (p_ref − p),  ω_cmd = ω_s + T_ω α_s + k_yaw (θ_ref − θ)
///
/// The index s marks the reference's velocity, yaw rate and their derivatives averaged over ±
/// corner_window_s. Jumps of speed and yaw rate between primitives thus become ramps that begin
/// before the jump. The vehicle can move sideways, as a multirotor does; its heading is controlled
/// independently of its motion.
class Quadrotor : public Vehicle {
 public:
  /// Starts in hover at its start position, in the state kFollow.
  Quadrotor(const scenario::RobotSpec& spec, double tracking_tolerance_m, std::uint64_t seed,
            Time start, const QuadrotorParameters& parameters = {});

  /// Accepts a plan if it is finite, not older than the newest plan, and begins near the course: at
  /// max(start, `now`) the distance is at most twice the tracking tolerance.
  PlanVerdict offer(const models::RobotPlan& plan, Time now);
  void command(models::OperatorAction action, Time now);
  /// Sets the error of the pose by which the vehicle flies: the rigid motion from the true to the
  /// assumed pose in the world. nullopt: it flies by its true pose.
  void fly_by(const std::optional<Pose2>& assumed_from_true) {
    assumed_from_true_ = assumed_from_true;
  }
  /// Steps from `now` by `dt_s` ≤ 0.02 s. Allocates only when old plans are removed.
  void step(Time now, double dt_s) override;

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double radius_m() const override { return limits_.radius_m; }
  [[nodiscard]] Pose3 world_from_body() const override;
  [[nodiscard]] const Eigen::Vector3d& position_world_m() const { return position_m_; }
  [[nodiscard]] Eigen::Vector3d velocity_world_mps() const override { return velocity_mps_; }
  [[nodiscard]] double yaw_rad() const { return yaw_rad_; }
  [[nodiscard]] double yaw_rate_radps() const { return yaw_rate_radps_; }
  [[nodiscard]] models::FlightState state() const { return state_; }
  [[nodiscard]] const Course& course() const { return course_; }
  /// Returns the status that is published on VEHICLE_<robot>.
  [[nodiscard]] models::VehicleStatus status(Time now) const;

 private:
  void fly(Time now, double dt_s);
  void fall(double dt_s);
  void step_gusts(double dt_s);
  [[nodiscard]] Pose2 pose() const;
  /// Returns the pose by which the vehicle flies.
  [[nodiscard]] Pose2 assumed_pose() const;
  [[nodiscard]] Eigen::Vector2d assumed_from_true(const Eigen::Vector2d& velocity_mps) const;
  [[nodiscard]] bool on_ground() const { return position_m_.z() <= 0.0; }

  std::string name_;
  models::VehicleLimits limits_;
  double height_m_;
  double tolerance_m_;
  QuadrotorParameters parameters_;
  std::mt19937_64 rng_;
  Course course_;
  Time start_;
  Eigen::Vector3d position_m_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  double yaw_rad_;
  double yaw_rate_radps_ = 0.0;
  Eigen::Vector2d wind_mps2_ = Eigen::Vector2d::Zero();
  std::optional<Pose2> assumed_from_true_;
  models::FlightState state_ = models::FlightState::kFollow;
};

}  // namespace vantage::sim
