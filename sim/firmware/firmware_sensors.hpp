#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"
#include "core/time.hpp"
#include "sim/firmware/multirotor.hpp"

namespace vantage::sim {

/// Sensor values of an autopilot at one instant. Local frame NED with its origin at the world's
/// origin (north is the world's x), body FRD. GPS is not simulated.
struct FirmwareSensors {
  Duration since_start{};
  Eigen::Vector3d gyro_body_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_body_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d magnetic_field_body_gauss = Eigen::Vector3d::Zero();
  double pressure_hpa = 1013.25;
  double pressure_altitude_m = 0.0;
  double temperature_c = 20.0;
  // True state, for firmware that simulates some sensors itself.
  Eigen::Vector3d position_local_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_local_mps = Eigen::Vector3d::Zero();
  Quaternion local_from_body = Quaternion::Identity();
  double battery_v = 12.6;
  double battery_a = 0.0;
  double battery_share = 1.0;
};

/// Sensor errors: 1σ of the white noise per sample and of the constant offsets.
struct SensorNoise {
  double gyro_sigma_radps = 0.003;
  double gyro_bias_sigma_radps = 0.002;
  double accelerometer_sigma_mps2 = 0.06;
  double accelerometer_bias_sigma_mps2 = 0.03;
  double magnetometer_sigma_gauss = 0.004;
  double barometer_sigma_m = 0.15;
};

/// Inertial unit, magnetometer and barometer of a Multirotor.
class SensorBoard {
 public:
  SensorBoard(const SensorNoise& noise, std::uint64_t seed);

  /// Returns the sensor values at one instant. Draws random numbers: call it once per sample.
  FirmwareSensors sample(const Multirotor& body, Duration since_start);

 private:
  Eigen::Vector3d draw(double sigma);

  SensorNoise noise_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d gyro_bias_radps_;
  Eigen::Vector3d accelerometer_bias_mps2_;
};

}  // namespace vantage::sim
