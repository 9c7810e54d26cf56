#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "models/belief/gaussian.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Belief of a planar target before its discovery by sensors that do not measure a position, for
/// example ranges alone: weighted Gaussians ("hypotheses").
///
/// The first measurement gives a hypothesis for each cell of a polar grid of the sensor's view,
/// with a weight in proportion to the cell's area and to the likelihood of the measurement: a ring
/// for a range, a ray for a bearing. Further measurements, of any robot and kind, update every
/// hypothesis by an unscented Kalman filter and multiply its weight by the likelihood. Improbable
/// hypotheses are dropped and similar ones merged, until located() returns a Gaussian.
///
/// Cost: 576 updates for the first measurement, then at most kMax per measurement. No allocation.
/// Source: Alspach, Sorenson (1972), Gaussian sums; Peach (1995), bearings-only tracking with a set
/// of range-parametrised filters; Julier, Uhlmann (2004), unscented transform.
class PositionHypotheses {
 public:
  static constexpr int kMax = 64;

  /// Starts with the first measurement. Returns false and leaves the object empty if no position in
  /// `world` is possible, or if the target model has three position coordinates.
  bool start(const scenario::EstimatorSpec& spec, const models::World& world,
             const models::SensorModel& sensor, const models::Viewpoint& from,
             const models::Measurement& measurement);
  [[nodiscard]] int size() const { return size_; }

  // The functions below require size() > 0.

  void predict(const models::TargetModel& model, double dt_s);
  /// Uses a measurement. Returns false and changes nothing if it contradicts every hypothesis.
  bool measure(const models::SensorModel& sensor, const models::Viewpoint& from,
               const models::Measurement& measurement);
  /// Uses an observation that did not report the target: multiplies the weight of each hypothesis
  /// with its mean in view by 1 − p_D.
  void miss(const models::World& world, const models::SensorModel& sensor,
            const models::Viewpoint& from, double detection_probability);
  /// Drops hypotheses outside of the world's free space, unless none would remain.
  void confine(const models::World& world);

  /// Returns the mean and covariance of all hypotheses if the position's largest σ is at most
  /// `sigma_max_m` and the hypotheses form one mode: the variance of the whole mixture is at most
  /// kOneMode times the mean variance of its hypotheses.
  [[nodiscard]] std::optional<models::Gaussian> located(double sigma_max_m) const;
  static constexpr double kOneMode = 5.0;

 private:
  struct Hypothesis {
    double weight = 0.0;
    models::Gaussian belief;
  };
  /// Keeps `candidate` if there is room, or if it can replace a less probable hypothesis.
  void offer(const Hypothesis& candidate);
  /// Normalises the weights, drops improbable hypotheses and merges similar ones.
  void reduce();
  void merge_similar();

  int size_ = 0;
  std::array<Hypothesis, kMax> hypotheses_;
};

}  // namespace vantage::estimator
