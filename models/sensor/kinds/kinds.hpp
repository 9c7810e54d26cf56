#pragma once

#include "models/sensor/law.hpp"

// The laws of our own sensors, one file each, and what several of them share.

namespace vantage::models::sensor_kinds {

// Listed in kinds.cpp.
extern const SensorLaw position;
extern const SensorLaw range;
extern const SensorLaw bearing;
extern const SensorLaw range_bearing;
extern const SensorLaw camera;

/// A law of what every kind has; what else it has is set on it.
constexpr SensorLaw law_of(std::string_view name, decltype(SensorLaw::measurement_dim) dim,
                           decltype(SensorLaw::observe) observe,
                           decltype(SensorLaw::jacobian) jacobian,
                           decltype(SensorLaw::variances) variances,
                           decltype(SensorLaw::information_bound) bound) {
  return {.name = name,
          .measurement_dim = dim,
          .observe = observe,
          .jacobian = jacobian,
          .variances = variances,
          .information_bound = bound};
}

constexpr double square(double x) { return x * x; }

constexpr int one_row(int /*position_dim*/) { return 1; }
constexpr int two_rows(int /*position_dim*/) { return 2; }

/// World to body of a level vehicle.
Eigen::Matrix3d body_from_world(const Viewpoint& from);

/// What the sensor says of a true range.
double reported_range_m(const SensorModel& sensor, double range_m);
/// ∂(reported range) / ∂position, a row.
Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> range_row(const SensorModel& sensor,
                                                                          const SightLine& to,
                                                                          int position_dim);
/// ∂bearing / ∂position, a row.
Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> bearing_row(const SightLine& to,
                                                                            int position_dim);
/// A bearing has no direction above the sensor, nor nearer than the least range.
bool is_beside(const SensorModel& sensor, const SightLine& to);

/// Information of a range and of a bearing, at most.
double range_information(const SensorModel& sensor, const ReachedDistances& reached);
double bearing_information(const SensorModel& sensor, const ReachedDistances& reached);

}  // namespace vantage::models::sensor_kinds
