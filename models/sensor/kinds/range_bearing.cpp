#include <algorithm>
#include <cmath>

#include "models/sensor/kinds/kinds.hpp"

// Measures distance and direction, (m, rad from body x).

namespace vantage::models::sensor_kinds {
namespace {

bool can_measure(const SensorModel& sensor, const Viewpoint& /*from*/, const SightLine& to) {
  return has_bearing(sensor, to);
}

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from, const SightLine& to,
                          int /*position_dim*/) {
  return Eigen::Vector2d(reported_range_m(sensor, to.range_m), bearing_rad(from, to));
}

MeasurementJacobian jacobian(const SensorModel& sensor, const Viewpoint& /*from*/,
                             const SightLine& to, int position_dim) {
  MeasurementJacobian H = MeasurementJacobian::Zero(2, position_dim);
  H.row(0) = range_row(sensor, to, position_dim);
  H.row(1) = bearing_row(to, position_dim);
  return H;
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& to, int /*position_dim*/) {
  const double growth = variance_growth(sensor, to.range_m);
  return Eigen::Vector2d(square(sensor.range_sigma_m) * growth,
                         square(sensor.bearing_sigma_rad) * growth);
}

// Range and bearing give information in orthogonal directions, so λ_max is the larger of the two.
double bound(const SensorModel& sensor, const ReachedDistances& reached) {
  if (reached.horizontal_far_m < sensor.range_min_m) {
    return 0.0;
  }
  return std::max(range_information(sensor, reached), bearing_information(sensor, reached));
}

std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim) {
  const double range_m = (z(0) - sensor.calibration.range_bias_m) / sensor.calibration.range_scale;
  const double drop_m = position_dim == 3 ? from.height_m : 0.0;
  if (!(range_m >= 0.0) || range_m < std::abs(drop_m)) {
    return std::nullopt;
  }
  const double rho_m = std::sqrt(square(range_m) - square(drop_m));
  const Eigen::Vector2d target_body_m(rho_m * std::cos(z(1)), rho_m * std::sin(z(1)));
  PositionVector target_world_m = PositionVector::Zero(position_dim);
  target_world_m.head<2>() = from.world_from_body * target_body_m;
  return target_world_m;
}

PlanarLaw planar_law(const SensorModel& sensor) {
  return {square(sensor.calibration.range_scale / sensor.range_sigma_m),
          1.0 / square(sensor.bearing_sigma_rad), 0.0};
}

}  // namespace

constinit const SensorLaw range_bearing = [] {
  SensorLaw law = law_of("range_bearing", two_rows, observe, jacobian, variances, bound);
  law.measures_range = true;
  law.measures_bearing = true;
  law.can_measure = can_measure;
  law.position_from = position_from;
  law.planar_law = planar_law;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
