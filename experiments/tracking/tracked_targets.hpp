#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/pose.hpp"
#include "estimator/filter/central_filter.hpp"
#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "sim/world/linear_targets.hpp"

namespace vantage::experiments {

/// Minimum range of observations in plans, m. The information of a bearing from a distance r is
/// proportional to 1/r², but the target position is known only to decimetres. Without this limit
/// robots would stay close to targets for information that no observation provides.
inline constexpr double kPlannedRangeMin_m = 3.0;

/// Returns the sensor of the tracking tasks: range and bearing up to 10 m within 94°, σ 0.15 m and
/// 5°.
/// Source: dissertation, section 4.F.1.
models::SensorModel tracking_sensor();

/// Square without obstacles from (0, 0) to (side_m, side_m), and its distance field for planning.
struct TrackingGround {
  explicit TrackingGround(double side_m);

  models::World world;
  models::DistanceField field;
};

/// Error of one target's belief after a step and its measurements.
struct TargetStep {
  double error_m = 0.0;  ///< m; position error
  double nees = 0.0;  ///< eᵀ Σ⁻¹ e of position and velocity; mean 4 for a consistent filter
  bool is_seen = false;  ///< observed by a robot that is not attacked
};

/// Start of the targets and processing of observations.
struct TargetSetting {
  int count = 10;
  double start_side_m = 64.0;  ///< m; side of the centred square in which targets start
  double q_m2ps3 = 0.001;      ///< density of the white acceleration
  double step_s = 0.5;
  double prior_position_sigma_m = 1.0;
  /// 1σ of the prior velocity. Targets start at rest; the value is √(q τ), the growth of one step.
  double prior_velocity_sigma_mps = 0.02;
  double detection_probability = 0.05;  ///< see estimator::CentralFilterSpec
  bool beliefs_stay_inside = true;  ///< true: beliefs are reflected at walls; targets always are
};

/// Targets that move as double integrators in a square world, mirrored at its walls, and the
/// central filter of a team that shares all observations.
///
/// Targets start at rest. Each prior mean is drawn around the true state with the prior's
/// covariance, so that the filter is consistent from the start. The targets' motion depends only on
/// `seed`; the beliefs depend on `seed` and on the robots' poses.
class TrackedTargets {
 public:
  /// `world` must outlive this object.
  TrackedTargets(const TargetSetting& setting, const models::World& world, std::uint64_t seed);

  /// Moves the targets and predicts the beliefs by one step.
  void move();
  /// Updates the beliefs with the observations of all robots at the present time, except robots
  /// with a nonzero `is_blind`.
  void observe(const models::SensorModel& sensor, const std::vector<Pose2>& poses,
               const std::vector<char>& is_blind);

  [[nodiscard]] const models::TargetModel& model() const { return filter_.model(); }
  [[nodiscard]] const std::vector<models::Gaussian>& beliefs() const { return filter_.beliefs(); }
  /// Returns one entry per target: nonzero if a robot observed the target in the last observe().
  [[nodiscard]] const std::vector<char>& is_seen() const { return filter_.is_seen(); }
  /// Returns the true states, in the order of the targets.
  [[nodiscard]] const std::vector<models::StateVector>& truth() const { return truth_.states(); }
  /// Returns the current errors, in the order of the targets.
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
