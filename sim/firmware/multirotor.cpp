#include "sim/firmware/multirotor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kGravityMps2 = 9.81;

struct Mount {
  double x;  ///< position forward, in arm lengths
  double y;  ///< position to the left, in arm lengths
  /// sign of the torque on the body about z; the propeller turns in the opposite direction
  double spin;
};
constexpr std::array<Mount, kMotors> kMounts{
    {{1.0, -1.0, -1.0}, {-1.0, 1.0, -1.0}, {1.0, 1.0, 1.0}, {-1.0, -1.0, 1.0}}};

}  // namespace

Multirotor::Multirotor(const MultirotorParameters& parameters, std::uint64_t seed,
                       const Pose2& start)
    : parameters_(parameters),
      rng_(random_stream(seed, "multirotor")),
      world_from_body_(lift(start, 0.0)),
      force_mps2_(0.0, 0.0, kGravityMps2) {}

void Multirotor::step(const Throttles& throttles, double dt_s) {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / kStepMaxS - 1e-9)));
  step_gusts(dt_s);
  for (int i = 0; i < steps; ++i) {
    substep(throttles, dt_s / steps);
  }
  battery_share_ =
      std::max(0.0, battery_share_ - dt_s * thrust_n() / (parameters_.mass_kg * kGravityMps2) /
                                         parameters_.battery_endurance_s);
}

double Multirotor::thrust_n() const {
  return std::accumulate(thrusts_n_.begin(), thrusts_n_.end(), 0.0);
}

void Multirotor::substep(const Throttles& throttles, double dt_s) {
  const MultirotorParameters& p = parameters_;
  const double follow = -std::expm1(-dt_s / p.motor_lag_s);
  Eigen::Vector3d torque_nm = -p.spin_drag_nms * rate_radps_;
  for (std::size_t i = 0; i < kMotors; ++i) {
    const double u = std::clamp(throttles[i], 0.0, 1.0);
    const double wanted_n =
        p.motor_thrust_max_n * (p.thrust_expo * u * u + (1.0 - p.thrust_expo) * u);
    thrusts_n_[i] += follow * (wanted_n - thrusts_n_[i]);
    torque_nm.x() += kMounts[i].y * p.arm_y_m * thrusts_n_[i];
    torque_nm.y() -= kMounts[i].x * p.arm_x_m * thrusts_n_[i];
    torque_nm.z() += kMounts[i].spin * p.torque_per_thrust_m * thrusts_n_[i];
  }
  const Quaternion& q = world_from_body_.rotation;
  const Eigen::Vector3d air_mps = p.wind_world_mps + gust_mps_;
  Eigen::Vector3d force_n = thrust_n() * (q * Eigen::Vector3d::UnitZ());
  add_ground_forces(force_n, torque_nm);
  // Wind does not move a body that stands on the ground.
  if (!is_on_ground_) {
    force_n += p.mass_kg * p.drag_per_s * (air_mps - velocity_mps_);
  }
  force_mps2_ = q.conjugate() * force_n / p.mass_kg;

  velocity_mps_ += dt_s * (force_n / p.mass_kg - Eigen::Vector3d(0.0, 0.0, kGravityMps2));
  world_from_body_.translation_m += dt_s * velocity_mps_;
  const Eigen::Vector3d momentum = p.inertia_kgm2.cwiseProduct(rate_radps_);
  rate_radps_ += dt_s * (torque_nm - rate_radps_.cross(momentum)).cwiseQuotient(p.inertia_kgm2);
  const double turned_rad = rate_radps_.norm() * dt_s;
  if (turned_rad > 0.0) {
    world_from_body_.rotation =
        (q * Quaternion(Eigen::AngleAxisd(turned_rad, rate_radps_.normalized()))).normalized();
  }
}

// Adds the forces of a spring and a damper under each foot. Each foot is held at its touch-down
// point until friction is exceeded.
void Multirotor::add_ground_forces(Eigen::Vector3d& force_n, Eigen::Vector3d& torque_body_nm) {
  const MultirotorParameters& p = parameters_;
  const Quaternion& q = world_from_body_.rotation;
  const double sunk_m = p.mass_kg * kGravityMps2 / (4.0 * p.foot_stiffness_npm);
  is_on_ground_ = false;
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    const Eigen::Vector3d foot_body_m(i % 2 == 0 ? p.foot_m : -p.foot_m,
                                      i < 2 ? p.foot_m : -p.foot_m, 0.0);
    const Eigen::Vector3d arm_m = q * foot_body_m;
    const Eigen::Vector3d foot_m = world_from_body_.translation_m + arm_m;
    const Eigen::Vector3d foot_mps = velocity_mps_ + q * rate_radps_.cross(foot_body_m);
    const double deep_m = sunk_m - foot_m.z();
    const double load_n =
        std::max(0.0, p.foot_stiffness_npm * deep_m - p.foot_damping_nspm * foot_mps.z());
    Foot& foot = feet_[i];
    if (deep_m <= 0.0 || load_n <= 0.0) {
      foot.is_down = false;
      continue;
    }
    if (!foot.is_down) {
      foot = {true, foot_m.head<2>()};
    }
    is_on_ground_ = true;
    Eigen::Vector2d grip_n = -p.foot_stiffness_npm * (foot_m.head<2>() - foot.anchor_m) -
                             p.foot_damping_nspm * foot_mps.head<2>();
    const double grip_max_n = p.friction * load_n;
    if (grip_n.norm() > grip_max_n) {  // the foot slides: its contact point moves along
      grip_n *= grip_max_n / grip_n.norm();
      foot.anchor_m = foot_m.head<2>() + grip_n / p.foot_stiffness_npm;
    }
    const Eigen::Vector3d push_n(grip_n.x(), grip_n.y(), load_n);
    force_n += push_n;
    torque_body_nm += foot_body_m.cross(q.conjugate() * push_n);
  }
}

void Multirotor::step_gusts(double dt_s) {
  const double keep = std::exp(-dt_s / parameters_.gust_memory_s);
  const double fresh_mps = parameters_.gust_sigma_mps * std::sqrt(1.0 - keep * keep);
  const Eigen::Vector3d share(1.0, 1.0, 1.0 / 3.0);
  for (int axis = 0; axis < 3; ++axis) {
    gust_mps_(axis) = keep * gust_mps_(axis) + share(axis) * fresh_mps * normal_(rng_);
  }
}

double Multirotor::battery_v() const {
  const MultirotorParameters& p = parameters_;
  const double rest_v = p.battery_empty_v + battery_share_ * (p.battery_full_v - p.battery_empty_v);
  return rest_v - p.battery_sag_v * thrust_n() / (p.mass_kg * kGravityMps2);
}

double Multirotor::battery_a() const {
  const double load = thrust_n() / (parameters_.mass_kg * kGravityMps2);
  return 0.3 + parameters_.battery_hover_a * load * std::sqrt(load);
}

}  // namespace vantage::sim
