#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "estimator/filter/distributed_filter.hpp"

namespace vantage::bench {

/// One case of the filter family.
struct FilterCase {
  const char* name;
  int targets;
  Eigen::Vector2d half_m;  ///< m; half side lengths of the room
  double range_max_m;      ///< m; range of the sensor
  bool is_oscillator;      ///< target model; true: damped oscillator, false: random walk
  bool has_samples;        ///< true: beliefs of unseen targets are stored as samples
};

/// Returns all cases: 5 targets in the lab's room and 100 in the field's.
const std::vector<FilterCase>& filter_cases();

/// Robot Q0's filter in a team of three robots that always receive each other, with targets that
/// wander from seeded positions.
class FilterRun {
 public:
  explicit FilterRun(const FilterCase& filter_case);

  /// Moves the targets and the robots, and makes the messages of the next step.
  void prepare_step();
  /// Runs the filter for the prepared step.
  void step();
  [[nodiscard]] const estimator::DistributedFilter& filter() const { return filter_; }

 private:
  Eigen::Vector2d anywhere_m();

  Eigen::Vector2d half_m_;
  models::SensorModel sensor_;
  estimator::DistributedFilter filter_;
  std::mt19937_64 rng_{1};
  std::vector<Eigen::Vector2d> truth_m_;
  std::vector<models::Gaussian> start_;
  std::vector<models::RobotMeasurement> looks_;
  models::RobotBelief teammate_;
  int steps_ = 0;
};

}  // namespace vantage::bench
