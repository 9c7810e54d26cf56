#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/tracked_targets.hpp"
#include "models/motion/unicycle.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// A team that tracks double integrators in a square field. The defaults are the source's sensor,
/// primitives and targets (dissertation 4 F.1) in a smaller field.
struct TrackingSpec {
  int robots = 1;
  double side_m = 40.0;
  double start_side_m = 30.0;  ///< robots and targets start in a square of this side in the middle
  int targets = 5;
  double q_m2ps3 = 0.001;  ///< density of the targets' white acceleration
  double step_s = 0.5;
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 0.02;
  double detection_probability =
      0.0;  ///< see experiments::TargetSetting; 0: empty looks tell nothing
  models::SensorModel sensor;
  std::vector<models::UnicycleControl> controls = models::standard_primitives();
  double radius_m = 0.25;  ///< of the disc that may not touch a wall
  int episode_steps = 200;
  JammerSpec jammer;

  TrackingSpec();
};

/// Reward: the negative mean over the targets of the entropy of position and velocity, nats; what
/// planner::SearchProblem minimises is an affine function of its sum. A robot whose control would
/// touch a wall stays where it is and turns as far as it would have. Robots do not see or touch
/// each other.
class TrackingTask final : public TeamTask {
 public:
  /// @throws UsageError for a spec that makes no sense, naming the rule.
  explicit TrackingTask(const TrackingSpec& spec);

  [[nodiscard]] int actions() const override { return static_cast<int>(spec_.controls.size()); }
  /// "self" (5), "teammates" (robots − 1, 4), "targets" (targets, 6): of each believed target its
  /// place in the body frame in diagonals of the field, its velocity there in units of 2 m/s, its
  /// entropy in tens of nats, and whether the team sees it now.
  [[nodiscard]] std::vector<ObservationPart> observation_parts() const override;
  [[nodiscard]] int observation_size() const override;
  void observe(int robot, std::span<float> out) const override;
  using TeamTask::observe;
  [[nodiscard]] double entropy_nats() const override;

  [[nodiscard]] const TrackingSpec& spec() const { return spec_; }
  [[nodiscard]] const models::World& world() const { return world_; }
  [[nodiscard]] const models::DistanceField& field() const { return field_; }
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  /// Of this episode. Precondition: reset() was called.
  [[nodiscard]] const experiments::TrackedTargets& targets() const { return *targets_; }

 private:
  void on_reset(std::uint64_t seed) override;
  double on_step(std::span<const std::int64_t> actions) override;
  void look();

  TrackingSpec spec_;
  models::World world_;
  models::DistanceField field_;
  std::vector<Pose2> poses_;
  std::optional<experiments::TrackedTargets> targets_;
  std::vector<double> target_entropy_nats_;
};

}  // namespace vantage::python
