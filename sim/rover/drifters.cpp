#include "sim/rover/drifters.hpp"

#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "sim/random.hpp"

namespace vantage::sim {
namespace {

constexpr double kGapM = 0.001;

}  // namespace

Drifters::Drifters(const models::World& world, std::vector<Disc> starts,
                   double acceleration_q_m2ps3, double speed_max_mps, std::uint64_t seed)
    : world_(world),
      discs_(std::move(starts)),
      velocity_(discs_.size(), Eigen::Vector2d::Zero()),
      q_m2ps3_(acceleration_q_m2ps3),
      speed_max_mps_(speed_max_mps),
      rng_(random_stream(seed, "drifters")) {
  require(q_m2ps3_ >= 0.0 && speed_max_mps_ > 0.0,
          "target_truth: acceleration_q must not be negative, speed_max_mps must be positive");
}

void Drifters::step(double dt_s) {
  std::normal_distribution<double> normal;
  const double sigma_mps = std::sqrt(q_m2ps3_ * dt_s);
  for (std::size_t i = 0; i < discs_.size(); ++i) {
    Eigen::Vector2d& v_mps = velocity_[i];
    v_mps.x() += sigma_mps * normal(rng_);
    v_mps.y() += sigma_mps * normal(rng_);
    if (v_mps.norm() > speed_max_mps_) {
      v_mps *= speed_max_mps_ / v_mps.norm();
    }
    const Eigen::Vector2d here_m = discs_[i].centre_m;
    if (is_free(i, here_m + v_mps * dt_s)) {
      discs_[i].centre_m += v_mps * dt_s;
      continue;
    }
    // A wall or a box face reverses one velocity component; a corner or another disc reverses both.
    const Eigen::Vector2d mirrored_x(-v_mps.x(), v_mps.y());
    const Eigen::Vector2d mirrored_y(v_mps.x(), -v_mps.y());
    if (is_free(i, here_m + mirrored_x * dt_s)) {
      v_mps = mirrored_x;
    } else if (is_free(i, here_m + mirrored_y * dt_s)) {
      v_mps = mirrored_y;
    } else {
      v_mps = -v_mps;
    }
  }
}

bool Drifters::is_free(std::size_t i, const Eigen::Vector2d& to_m) const {
  if (models::swept_clearance_m(world_, discs_[i].centre_m, to_m) < discs_[i].radius_m + kGapM) {
    return false;
  }
  for (std::size_t j = 0; j < discs_.size(); ++j) {
    if (j != i &&
        (to_m - discs_[j].centre_m).norm() < discs_[i].radius_m + discs_[j].radius_m + kGapM) {
      return false;
    }
  }
  return true;
}

}  // namespace vantage::sim
