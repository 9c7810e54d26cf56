#pragma once

#include <span>
#include <vector>

#include "models/belief/gaussian.hpp"
#include "models/exchange/messages.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// Parameters of a CentralFilter: the targets' motion and the use of observations.
struct CentralFilterSpec {
  models::TargetModel model;
  double step_s = 0.5;
  /// Detection probability assumed for observations without a detection; 0: such observations are
  /// not used. Successive observations see nearly the same area, and a Gaussian cannot represent
  /// this. The value must be far below the sensor's detection probability; otherwise the filter
  /// becomes overconfident about where targets are not.
  double detection_probability = 0.0;
  bool targets_stay_inside = true;  ///< true: beliefs are reflected at the world's bounds
};

/// Central filter of a team that shares all observations without delay. All targets are known from
/// the beginning and are numbered. One extended Kalman filter in moment form estimates each target,
/// as in the simulations of chapter 4 of the dissertation. For targets that must be discovered, and
/// for late or lost messages, see DistributedFilter.
class CentralFilter {
 public:
  /// `world` must outlive this object.
  /// @param priors prior beliefs of target 0, 1, …, each of the model's dimension
  CentralFilter(const CentralFilterSpec& spec, const models::World& world,
                std::vector<models::Gaussian> priors);

  /// Predicts all beliefs by one step.
  void predict();
  /// Uses the observations of one instant: one per robot that was not jammed. For each target,
  /// observations that do not report it are used first, then those that report it, each in the
  /// given order. The effect of missed detections thus does not depend on the measurements of the
  /// same instant.
  void update(const models::SensorModel& sensor, std::span<const models::RobotMeasurement> looks);

  [[nodiscard]] const models::TargetModel& model() const { return spec_.model; }
  [[nodiscard]] const std::vector<models::Gaussian>& beliefs() const { return beliefs_; }
  /// Returns one value per target: nonzero if a measurement of the target in the last observations
  /// was used.
  [[nodiscard]] const std::vector<char>& is_seen() const { return is_seen_; }

 private:
  CentralFilterSpec spec_;
  const models::World* world_;
  models::StateMatrix A_;
  models::StateMatrix W_;
  std::vector<models::Gaussian> beliefs_;
  std::vector<char> is_seen_;
};

}  // namespace vantage::estimator
