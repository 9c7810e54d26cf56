#include "models/sensor/kinds/kinds.hpp"

// Measures the direction to the target, rad from body x.

namespace vantage::models::sensor_kinds {
namespace {

bool can_measure(const SensorModel& sensor, const Viewpoint& /*from*/, const SightLine& to) {
  return has_bearing(sensor, to);
}

MeasurementVector observe(const SensorModel& /*sensor*/, const Viewpoint& from, const SightLine& to,
                          int /*position_dim*/) {
  return Eigen::Matrix<double, 1, 1>(bearing_rad(from, to));
}

MeasurementJacobian jacobian(const SensorModel& /*sensor*/, const Viewpoint& /*from*/,
                             const SightLine& to, int position_dim) {
  return bearing_row(to, position_dim);
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& to, int /*position_dim*/) {
  return Eigen::Matrix<double, 1, 1>(square(sensor.bearing_sigma_rad) *
                                     variance_growth(sensor, to.range_m));
}

PlanarLaw planar_law(const SensorModel& sensor) {
  return {0.0, 1.0 / square(sensor.bearing_sigma_rad), 0.0};
}

}  // namespace

constinit const SensorLaw bearing = [] {
  SensorLaw law = law_of("bearing", one_row, observe, jacobian, variances, bearing_information);
  law.measures_bearing = true;
  law.can_measure = can_measure;
  law.planar_law = planar_law;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
