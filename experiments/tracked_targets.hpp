#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/pose.hpp"
#include "estimator/central_filter.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"
#include "sim/world/linear_targets.hpp"

namespace vantage::experiments {

/// One target after a step and its measurements.
struct TargetStep {
  double error_m = 0.0;  ///< of the believed position
  double nees = 0.0;  ///< eᵀ Σ⁻¹ e of position and velocity; of a consistent filter 4 in the mean
  bool is_seen = false;  ///< by a robot that is not attacked
};

/// How targets begin and how looks at them are used.
struct TargetSetting {
  int count = 10;
  double start_side_m = 64.0;  ///< they start in a square of this side in the middle of the world
  double q_m2ps3 = 0.001;      ///< density of the white acceleration
  double step_s = 0.5;
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 0.02;
  double detection_probability = 0.05;  ///< see estimator::CentralFilterSpec
  bool beliefs_stay_inside = true;      ///< mirrored at the walls, as the targets are at all times
};

/// Double integrators in a square world, mirrored at its walls, and what a team that shares
/// everything believes of them by the central filter.
///
/// Targets start at rest; each prior mean is drawn about the truth with the prior's covariance, so
/// that the filter is consistent from the beginning. All of it depends on `seed` and on where the
/// robots look, on nothing else; where targets go depends on `seed` alone.
class TrackedTargets {
 public:
  /// `world` must outlive this.
  TrackedTargets(const TargetSetting& setting, const models::World& world, std::uint64_t seed);

  /// One step of targets and beliefs.
  void move();
  /// Looks of all robots at once; those for which `is_blind` is not 0 see nothing and say nothing.
  void look(const models::SensorModel& sensor, const std::vector<Pose2>& poses,
            const std::vector<char>& is_blind);

  [[nodiscard]] const models::TargetModel& model() const { return filter_.model(); }
  [[nodiscard]] const std::vector<models::Gaussian>& beliefs() const { return filter_.beliefs(); }
  /// Not 0 of those that a robot saw in the last look, by target.
  [[nodiscard]] const std::vector<char>& is_seen() const { return filter_.is_seen(); }
  /// As they are now, in the order of the targets.
  [[nodiscard]] std::vector<TargetStep> steps() const;

 private:
  struct Starts;
  TrackedTargets(const TargetSetting& setting, const models::World& world, Starts starts,
                 std::uint64_t noise_seed);

  std::mt19937_64 noise_rng_;
  estimator::CentralFilter filter_;
  sim::LinearTargets truth_;
};

}  // namespace vantage::experiments
