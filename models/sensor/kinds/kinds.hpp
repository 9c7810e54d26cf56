#pragma once

#include "models/sensor/law.hpp"

// Measurement models of the built-in sensors, one file for each sensor, and functions that several
// of them share.

namespace vantage::models::sensor_kinds {

// The list of all measurement models is in kinds.cpp.
extern const SensorLaw position;
extern const SensorLaw range;
extern const SensorLaw bearing;
extern const SensorLaw range_bearing;
extern const SensorLaw camera;
extern const SensorLaw range_rate;

/// Returns a measurement model with the required functions; the caller sets the optional fields.
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

/// Returns the rotation from world to body of a level vehicle.
Eigen::Matrix3d body_from_world(const Viewpoint& from);

/// Returns the sensor's reading for a true range, including its calibration.
double reported_range_m(const SensorModel& sensor, double range_m);
/// Returns ∂(reported range) / ∂position, a row.
Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> range_row(const SensorModel& sensor,
                                                                          const SightLine& to,
                                                                          int position_dim);
/// Returns ∂bearing / ∂position, a row.
Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> bearing_row(const SightLine& to,
                                                                            int position_dim);
/// True if a bearing is defined: the target is not directly above or below the sensor, and is
/// farther than the minimum range.
bool has_bearing(const SensorModel& sensor, const SightLine& to);

/// Return upper bounds of the information from a range and from a bearing.
double range_information(const SensorModel& sensor, const ReachedDistances& reached);
double bearing_information(const SensorModel& sensor, const ReachedDistances& reached);

}  // namespace vantage::models::sensor_kinds
