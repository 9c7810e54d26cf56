#include "models/sensor/kinds/kinds.hpp"

// Measures the target's position in the body frame, m.

namespace vantage::models::sensor_kinds {
namespace {

MeasurementVector observe(const SensorModel& /*sensor*/, const Viewpoint& from, const SightLine& to,
                          int position_dim) {
  const Eigen::Vector3d target_body_m = body_from_world(from) * to.offset_world_m;
  return target_body_m.head(position_dim);
}

MeasurementJacobian jacobian(const SensorModel& /*sensor*/, const Viewpoint& from,
                             const SightLine& /*to*/, int position_dim) {
  return body_from_world(from).topLeftCorner(position_dim, position_dim);
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& /*to*/, int position_dim) {
  return MeasurementVector::Constant(position_dim, square(sensor.position_sigma_m));
}

double bound(const SensorModel& sensor, const ReachedDistances& /*reached*/) {
  return 1.0 / square(sensor.position_sigma_m);
}

std::optional<PositionVector> position_from(const SensorModel& /*sensor*/, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim) {
  PositionVector target_world_m = PositionVector::Zero(position_dim);
  const Eigen::Vector2d target_body_m = z.head<2>();
  target_world_m.head<2>() = from.world_from_body * target_body_m;
  if (position_dim == 3) {
    target_world_m(2) = from.height_m + z(2);
  }
  return target_world_m;
}

PlanarLaw planar_law(const SensorModel& sensor) {
  return {0.0, 0.0, 1.0 / square(sensor.position_sigma_m)};
}

}  // namespace

constinit const SensorLaw position = [] {
  SensorLaw law = law_of(
      "position", [](int position_dim) { return position_dim; }, observe, jacobian, variances,
      bound);
  law.is_linear = true;
  law.position_from = position_from;
  law.planar_law = planar_law;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
