#include "sim/autopilot/airframe.hpp"

#include <algorithm>
#include <cmath>

#include "core/angle.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kGravityMps2 = 9.81;

double share_of_lag(double dt_s, double lag_s) { return -std::expm1(-dt_s / lag_s); }

}  // namespace

Airframe::Airframe(const AirframeParameters& parameters, std::uint64_t seed,
                   const Eigen::Vector3d& position_m, double yaw_rad)
    : parameters_(parameters),
      rng_(random_stream(seed, "airframe")),
      ground_m_(position_m.z()),
      position_m_(position_m),
      yaw_rad_(yaw_rad),
      battery_share_(parameters.battery_start_share) {}

void Airframe::step(bool motors_on, const Eigen::Vector3d& acceleration_mps2, double yaw_rate_radps,
                    double dt_s) {
  const AirframeParameters& p = parameters_;
  step_gusts(dt_s);
  // Computes the specific force for the acceleration; thrust is in the −z direction (up).
  Eigen::Vector3d force = acceleration_mps2 - Eigen::Vector3d(0.0, 0.0, kGravityMps2);
  force.z() = std::min(force.z(), -0.2 * kGravityMps2);
  const double level_max = -force.z() * std::tan(p.tilt_max_rad);
  const double level = force.head<2>().norm();
  if (level > level_max) {
    force.head<2>() *= level_max / level;
  }
  const Eigen::Vector3d wanted_down =
      motors_on ? Eigen::Vector3d(-force.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  const double wanted_mps2 = motors_on ? std::min(force.norm(), p.thrust_max_mps2) : 0.0;
  down_body_ += share_of_lag(dt_s, p.tilt_lag_s) * (wanted_down - down_body_);
  down_body_.normalize();
  thrust_mps2_ += share_of_lag(dt_s, p.thrust_lag_s) * (wanted_mps2 - thrust_mps2_);
  yaw_rate_radps_ +=
      share_of_lag(dt_s, p.yaw_rate_lag_s) * ((motors_on ? yaw_rate_radps : 0.0) - yaw_rate_radps_);

  const Eigen::Vector3d wind_mps = p.wind_mean_mps + gust_mps_;
  const Eigen::Vector3d old_mps = velocity_mps_;
  const Eigen::Vector3d old_m = position_m_;
  velocity_mps_ += dt_s * (Eigen::Vector3d(0.0, 0.0, kGravityMps2) - thrust_mps2_ * down_body_ +
                           p.drag_per_s * (wind_mps - velocity_mps_));
  position_m_ += 0.5 * dt_s * (old_mps + velocity_mps_);
  if (position_m_.z() >= ground_m_) {
    if (old_m.z() >= ground_m_) {
      position_m_ = old_m;  // wind does not move a body that stands on the ground
    }
    position_m_.z() = ground_m_;
    velocity_mps_.setZero();
    yaw_rate_radps_ = 0.0;
    down_body_ = Eigen::Vector3d::UnitZ();
  }
  yaw_rad_ = wrap_to_pi(yaw_rad_ + dt_s * yaw_rate_radps_);
  battery_share_ =
      std::max(0.0, battery_share_ - dt_s * (thrust_mps2_ / kGravityMps2) / p.battery_endurance_s);
}

void Airframe::step_gusts(double dt_s) {
  const double keep = std::exp(-dt_s / parameters_.wind_memory_s);
  const double fresh = parameters_.wind_sigma_mps * std::sqrt(1.0 - keep * keep);
  std::normal_distribution<double> normal;
  for (int axis = 0; axis < 2; ++axis) {
    gust_mps_(axis) = keep * gust_mps_(axis) + fresh * normal(rng_);
  }
}

Quaternion Airframe::local_from_body() const {
  const Quaternion tilt = Quaternion::FromTwoVectors(Eigen::Vector3d::UnitZ(), down_body_);
  return tilt * Quaternion(Eigen::AngleAxisd(yaw_rad_, Eigen::Vector3d::UnitZ()));
}

double Airframe::battery_v() const {
  const double rest_v = parameters_.battery_empty_v +
                        battery_share_ * (parameters_.battery_full_v - parameters_.battery_empty_v);
  return rest_v - parameters_.battery_sag_v * thrust_mps2_ / kGravityMps2;
}

}  // namespace vantage::sim
