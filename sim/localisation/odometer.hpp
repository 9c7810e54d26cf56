#pragma once

#include <cstdint>
#include <random>
#include <string>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::sim {

/// Simulated odometer of one robot. The reports have errors that the localizer models (white noise
/// and slowly varying errors) and errors that it does not model (scale, bias and slip).
class Odometer {
 public:
  Odometer(const scenario::SimulatedOdometerSpec& spec, const scenario::OdometryNoiseSpec& noise,
           const std::string& robot, std::uint64_t seed);

  /// Returns the reported displacement (forward m, left m, turn rad) of a robot that moved by
  /// `from_to` in `duration_s`. Draws random numbers: call it once per report.
  Eigen::Vector3d report(const Pose2& from_to, double duration_s);
  /// Returns the covariance that the odometer states for `report`.
  [[nodiscard]] Eigen::Matrix3d covariance(const Eigen::Vector3d& report, double duration_s) const;
  [[nodiscard]] bool is_slipping() const { return slip_left_s_ > 0.0; }

 private:
  double normal() { return std::normal_distribution<double>()(rng_); }
  void renew(double& error, double sigma, double time_s, double duration_s);

  scenario::SimulatedOdometerSpec spec_;
  scenario::OdometryNoiseSpec noise_;
  std::mt19937_64 rng_;
  double turn_error_radps_ = 0.0;  ///< true minus reported turn rate
  double speed_error_ = 0.0;       ///< true / reported displacement − 1
  double slip_left_s_ = 0.0;       ///< s; until the end of the slip
};

}  // namespace vantage::sim
