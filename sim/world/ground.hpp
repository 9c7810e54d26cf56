#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "scenario/scenario.hpp"
#include "sim/rover/drifters.hpp"
#include "sim/rover/fleet.hpp"

namespace vantage::sim {

/// True motion of the scenario's targets, for all kinds of motion.
class Ground {
 public:
  Ground(const scenario::Scenario& scenario, std::uint64_t seed);

  /// Keeps the centres of rovers at least `distance_m` from these points from now on.
  void keep_out(std::vector<Eigen::Vector2d> centres_m, double distance_m);
  void decide(double elapsed_s);
  void step(double dt_s);

  /// Returns the pose of target `i`, in the scenario's order of targets.
  [[nodiscard]] Pose2 world_from_body(std::size_t i) const;
  [[nodiscard]] Eigen::Vector2d velocity_mps(std::size_t i) const;
  /// Returns the rovers; null if the targets are not rovers.
  [[nodiscard]] const RoverFleet* rovers() const { return rovers_ ? &*rovers_ : nullptr; }

 private:
  std::vector<Pose2> starts_;
  std::optional<RoverFleet> rovers_;
  std::optional<Drifters> drifters_;
};

}  // namespace vantage::sim
