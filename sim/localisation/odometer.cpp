#include "sim/localisation/odometer.hpp"

#include <algorithm>
#include <cmath>

#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kSpeedErrorMin = -0.9;  // lower limit that keeps 1 + error positive
constexpr double kSigmaMin = 1e-6;       // m or rad; lower limit for a positive definite covariance

}  // namespace

Odometer::Odometer(const scenario::SimulatedOdometerSpec& spec,
                   const scenario::OdometryNoiseSpec& noise, const std::string& robot,
                   std::uint64_t seed)
    : spec_(spec), noise_(noise), rng_(random_stream(seed, "odometer:" + robot)) {
  noise_.turn_sigma_rad_per_sqrt_s *= spec.noise_scale;
  noise_.turn_sigma_per_sqrt_rad *= spec.noise_scale;
  noise_.slide_sigma_per_sqrt_m *= spec.noise_scale;
  noise_.turn_drift_radps *= spec.noise_scale;
  noise_.speed_drift_share *= spec.noise_scale;
  turn_error_radps_ = noise_.turn_drift_radps * normal();
  speed_error_ = std::max(noise_.speed_drift_share * normal(), kSpeedErrorMin);
}

void Odometer::renew(double& error, double sigma, double time_s, double duration_s) {
  const double keep = std::exp(-duration_s / time_s);
  error = keep * error + sigma * std::sqrt(1.0 - keep * keep) * normal();
}

Eigen::Vector3d Odometer::report(const Pose2& from_to, double duration_s) {
  const double slip_begins = 1.0 - std::exp(-spec_.slips_per_min / 60.0 * duration_s);
  slip_left_s_ = std::max(slip_left_s_ - duration_s, 0.0);
  if (std::uniform_real_distribution<double>()(rng_) < slip_begins) {
    slip_left_s_ = spec_.slip_s;
  }
  const double distance_m = from_to.position_m().norm();
  const double slide_m = noise_.slide_sigma_per_sqrt_m * std::sqrt(distance_m);
  const double turn_sigma_rad =
      std::hypot(noise_.turn_sigma_rad_per_sqrt_s * std::sqrt(duration_s),
                 noise_.turn_sigma_per_sqrt_rad * std::sqrt(std::abs(from_to.yaw_rad)));
  const double scale = spec_.speed_scale * (is_slipping() ? 1.0 + spec_.slip_share : 1.0);
  const Eigen::Vector3d reported(scale * from_to.x_m / (1.0 + speed_error_) + slide_m * normal(),
                                 scale * from_to.y_m + slide_m * normal(),
                                 spec_.turn_scale * from_to.yaw_rad +
                                     (spec_.turn_bias_radps - turn_error_radps_) * duration_s +
                                     turn_sigma_rad * normal());
  renew(turn_error_radps_, noise_.turn_drift_radps, noise_.turn_drift_time_s, duration_s);
  renew(speed_error_, noise_.speed_drift_share, noise_.speed_drift_time_s, duration_s);
  speed_error_ = std::max(speed_error_, kSpeedErrorMin);
  return reported;
}

Eigen::Matrix3d Odometer::covariance(const Eigen::Vector3d& report, double duration_s) const {
  const double distance_m = report.head<2>().norm();
  const double slide_m = noise_.slide_sigma_per_sqrt_m * std::sqrt(distance_m);
  const double forward_m = std::hypot(slide_m, noise_.speed_drift_share * report.x());
  const double turn_rad =
      std::hypot(noise_.turn_sigma_rad_per_sqrt_s * std::sqrt(duration_s),
                 noise_.turn_sigma_per_sqrt_rad * std::sqrt(std::abs(report.z())),
                 noise_.turn_drift_radps * duration_s);
  const Eigen::Vector3d sigma(forward_m, slide_m, turn_rad);
  return sigma.cwiseMax(kSigmaMin).cwiseAbs2().asDiagonal();
}

}  // namespace vantage::sim
