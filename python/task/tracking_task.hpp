#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/tracking/tracked_targets.hpp"
#include "models/motion/unicycle.hpp"
#include "models/sensor/sensor.hpp"
#include "python/task/team_task.hpp"

namespace vantage::python {

/// Parameters of the tracking of double integrators by a team in a square field. Sensor, motion
/// primitives and targets are those of the dissertation (section 4.F.1); the field is smaller.
struct TrackingSpec {
  int robots = 1;
  double side_m = 40.0;
  /// The robots start in the square of the targets. Missed detections are not used by default.
  experiments::TargetSetting targets = {
      .count = 5, .start_side_m = 30.0, .detection_probability = 0.0};
  models::SensorModel sensor = experiments::tracking_sensor();
  std::vector<models::UnicycleControl> controls = models::standard_primitives();
  double radius_m = 0.25;  ///< m; radius of the robot's disc, which must not touch a wall
  int episode_steps = 200;
  JammerSpec jammer;

  TrackingSpec() { sensor.range_min_m = 0.1; }
};

/// Tracking task. The reward is minus the mean over the targets of the entropy of position and
/// velocity, nats. The cost of planner::SearchProblem is an affine function of the sum of rewards.
/// A robot that would touch a wall only turns and does not move. Robots do not occlude or collide
/// with each other.
class TrackingTask final : public TeamTask {
 public:
  /// @throws UsageError for an invalid spec; the text states the rule.
  explicit TrackingTask(const TrackingSpec& spec);

  [[nodiscard]] int actions() const override { return static_cast<int>(spec_.controls.size()); }
  /// Returns the parts "self" (5), "teammates" (robots − 1, 4) and "targets" (targets, 6). For each
  /// estimated target: position in the body frame in units of the field's diagonal, velocity in
  /// that frame in units of 2 m/s, entropy in units of 10 nats, and 1 if the team detects the
  /// target at this step.
  [[nodiscard]] std::vector<ObservationPart> observation_parts() const override;
  [[nodiscard]] int observation_size() const override;
  void observe(int robot, std::span<float> out) const override;
  using TeamTask::observe;
  [[nodiscard]] double entropy_nats() const override;

  [[nodiscard]] const TrackingSpec& spec() const { return spec_; }
  [[nodiscard]] const models::World& world() const { return ground_.world; }
  [[nodiscard]] const models::DistanceField& field() const { return ground_.field; }
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  /// Returns the targets of the current episode. Precondition: reset() was called.
  [[nodiscard]] const experiments::TrackedTargets& targets() const { return *targets_; }

 private:
  void on_reset(std::uint64_t seed) override;
  double on_step(std::span<const std::int64_t> actions) override;
  void update_beliefs();

  TrackingSpec spec_;
  experiments::TrackingGround ground_;
  std::vector<Pose2> poses_;
  std::optional<experiments::TrackedTargets> targets_;
  std::vector<double> target_entropy_nats_;
};

}  // namespace vantage::python
