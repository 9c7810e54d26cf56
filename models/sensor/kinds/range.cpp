#include "models/sensor/kinds/kinds.hpp"

// Measures the distance to the target, m.

namespace vantage::models::sensor_kinds {
namespace {

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& /*from*/, const SightLine& to,
                          int /*position_dim*/) {
  return Eigen::Matrix<double, 1, 1>(reported_range_m(sensor, to.range_m));
}

MeasurementJacobian jacobian(const SensorModel& sensor, const Viewpoint& /*from*/,
                             const SightLine& to, int position_dim) {
  return range_row(sensor, to, position_dim);
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& to, int /*position_dim*/) {
  return Eigen::Matrix<double, 1, 1>(square(sensor.range_sigma_m) *
                                     variance_growth(sensor, to.range_m));
}

PlanarLaw planar_law(const SensorModel& sensor) {
  return {square(sensor.calibration.range_scale / sensor.range_sigma_m), 0.0, 0.0};
}

}  // namespace

constinit const SensorLaw range = [] {
  SensorLaw law = law_of("range", one_row, observe, jacobian, variances, range_information);
  law.measures_range = true;
  law.planar_law = planar_law;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
