#pragma once

#include <span>
#include <vector>

#include "models/belief/gaussian.hpp"
#include "models/exchange/messages.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"

namespace vantage::estimator {

/// What a CentralFilter has to know of the targets and of looks at them.
struct CentralFilterSpec {
  models::TargetModel model;
  double step_s = 0.5;
  /// With which a look that finds nothing moves a belief away; 0: such looks are not used. Looks
  /// of successive steps are nearly the same look, which a Gaussian cannot remember: far below the
  /// sensor's own probability, or the filter grows sure of where targets are not.
  double detection_probability = 0.0;
  bool targets_stay_inside = true;  ///< of the world's bounds: beliefs are reflected there
};

/// What a team believes whose robots hear each other's looks at once and whose targets are known
/// from the beginning, by their numbers: one extended Kalman filter a target, in moments, step by
/// step. What the source's simulations of ch. 4 ask for. A robot that has to discover targets and
/// hears others late or never runs a DistributedFilter.
class CentralFilter {
 public:
  /// `world` must outlive this. @param priors  of target 0, 1, …, each of the model's dimension
  CentralFilter(const CentralFilterSpec& spec, const models::World& world,
                std::vector<models::Gaussian> priors);

  /// One step of the targets.
  void predict();
  /// The looks of one instant, at most one of a robot, each of every robot that was not jammed: of
  /// each target first those that do not report it, then those that do, in their order. What robots
  /// that do not see it know does not depend on a measurement, and a narrow belief beside a field
  /// of view is not touched by it.
  void look(const models::SensorModel& sensor, std::span<const models::DetectionSet> looks);

  [[nodiscard]] const models::TargetModel& model() const { return spec_.model; }
  [[nodiscard]] const std::vector<models::Gaussian>& beliefs() const { return beliefs_; }
  /// Not 0 of those of which the last looks brought a measurement that was used, by target.
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
