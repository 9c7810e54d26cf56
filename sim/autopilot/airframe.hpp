#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"
#include "core/pose.hpp"

namespace vantage::sim {

/// Parameters of a multirotor body: thrust per mass along its z axis, first-order lags of tilt and
/// thrust, drag in gusty wind, and a battery with a voltage that drops under load. Local frame: z
/// down (NED), body FRD.
struct AirframeParameters {
  double tilt_lag_s = 0.10;
  double thrust_lag_s = 0.05;
  double yaw_rate_lag_s = 0.15;
  double tilt_max_rad = 0.6;
  double thrust_max_mps2 = 20.0;
  double drag_per_s = 0.25;
  Eigen::Vector3d wind_mean_mps = Eigen::Vector3d::Zero();
  double wind_sigma_mps = 0.3;  ///< m/s; 1σ of gusts on each horizontal axis
  double wind_memory_s = 2.0;
  double battery_endurance_s = 900.0;  ///< s; hover time from full to empty
  double battery_start_share = 1.0;
  double battery_full_v = 12.6;
  double battery_empty_v = 10.5;
  double battery_sag_v = 0.8;  ///< V; voltage drop at hover thrust
};

class Airframe {
 public:
  Airframe(const AirframeParameters& parameters, std::uint64_t seed,
           const Eigen::Vector3d& position_m, double yaw_rad);

  /// Steps by `dt_s` ≤ 0.01 s with a commanded acceleration (NED) and yaw rate (clockwise seen from
  /// above). With the motors off the body falls.
  void step(bool motors_on, const Eigen::Vector3d& acceleration_mps2, double yaw_rate_radps,
            double dt_s);

  [[nodiscard]] const Eigen::Vector3d& position_m() const { return position_m_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_mps() const { return velocity_mps_; }
  [[nodiscard]] double yaw_rad() const { return yaw_rad_; }
  [[nodiscard]] double yaw_rate_radps() const { return yaw_rate_radps_; }
  [[nodiscard]] Quaternion local_from_body() const;
  [[nodiscard]] bool is_on_ground() const { return position_m_.z() >= ground_m_; }
  [[nodiscard]] double battery_share() const { return battery_share_; }
  [[nodiscard]] double battery_v() const;
  /// Returns the ratio of the thrust to the maximum thrust.
  [[nodiscard]] double thrust_share() const { return thrust_mps2_ / parameters_.thrust_max_mps2; }

  /// Adds `velocity_mps` to the velocity immediately, as a hand, a gust or a tether does.
  void push(const Eigen::Vector3d& velocity_mps) { velocity_mps_ += velocity_mps; }
  void set_battery_share(double share) { battery_share_ = share; }

 private:
  void step_gusts(double dt_s);

  AirframeParameters parameters_;
  std::mt19937_64 rng_;
  double ground_m_;  ///< m; z of the body when it stands on the ground
  Eigen::Vector3d position_m_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  /// z axis of the body in the local frame; unit vector
  Eigen::Vector3d down_body_ = Eigen::Vector3d::UnitZ();
  double yaw_rad_;
  double yaw_rate_radps_ = 0.0;
  double thrust_mps2_ = 0.0;
  Eigen::Vector3d gust_mps_ = Eigen::Vector3d::Zero();
  double battery_share_;
};

}  // namespace vantage::sim
