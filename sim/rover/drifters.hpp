#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>

#include "models/world/world.hpp"
#include "sim/rover/route.hpp"

namespace vantage::sim {

/// Discs with white acceleration of density q, v ← v + √(q dt) n with standard normal n. They
/// bounce off walls, obstacles and each other. Their speed is limited; they start at zero speed.
class Drifters {
 public:
  Drifters(const models::World& world, std::vector<Disc> starts, double acceleration_q_m2ps3,
           double speed_max_mps, std::uint64_t seed);

  /// Moves each disc in turn. If the motion would end within 1 mm of a wall, an obstacle or another
  /// disc, the disc does not move and its velocity is reflected. Discs therefore never touch.
  void step(double dt_s);

  [[nodiscard]] std::size_t size() const { return discs_.size(); }
  [[nodiscard]] const Disc& disc(std::size_t i) const { return discs_[i]; }
  [[nodiscard]] const Eigen::Vector2d& velocity_mps(std::size_t i) const { return velocity_[i]; }

 private:
  [[nodiscard]] bool is_free(std::size_t i, const Eigen::Vector2d& to_m) const;

  models::World world_;
  std::vector<Disc> discs_;
  std::vector<Eigen::Vector2d> velocity_;
  double q_m2ps3_;
  double speed_max_mps_;
  std::mt19937_64 rng_;
};

}  // namespace vantage::sim
