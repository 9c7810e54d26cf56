#pragma once

#include "models/sensor/sensor.hpp"
#include "test/support/random.hpp"

// Test sensors of each kind, and random targets around a sensor.

namespace vantage::test {

inline const auto kKinds = models::all_sensor_kinds();

inline models::SensorModel of_kind(models::SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_min_m = 0.1;
  return sensor;
}

inline models::PositionVector random_target(Random& random, int dim, double half_side_m) {
  models::PositionVector target = models::PositionVector::Zero(dim);
  target.head(2) = random.vector<2>(-half_side_m, half_side_m);
  if (dim == 3) {
    target(2) = random.uniform(0.0, 1.0);
  }
  return target;
}

}  // namespace vantage::test
