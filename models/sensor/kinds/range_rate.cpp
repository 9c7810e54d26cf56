#include <algorithm>
#include <limits>

#include "models/sensor/kinds/kinds.hpp"

// Measures the distance to the target and the rate at which it changes because of the target's
// motion, (m, m/s), like a radar that compensates for its own motion.

namespace vantage::models::sensor_kinds {
namespace {

constexpr SensorParameter kParameters[] = {
    {"range_rate_sigma_mps", "m/s", 0.1, ParameterRule::kAboveZero, "1σ of a range rate"}};

double rate_variance(const SensorModel& sensor, double range_m) {
  return square(own_parameter(sensor, 0)) * variance_growth(sensor, range_m);
}

/// Returns the unit vector towards the target, horizontal for a planar target.
Eigen::Vector3d direction(const SightLine& to, int position_dim) {
  Eigen::Vector3d u = to.offset_world_m / to.range_m;
  u.tail(3 - position_dim).setZero();
  return u;
}

/// Returns the target's velocity in space.
Eigen::Vector3d velocity_mps(const SightLine& to) {
  return {to.velocity_world_mps.x(), to.velocity_world_mps.y(), 0.0};
}

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& /*from*/, const SightLine& to,
                          int position_dim) {
  return Eigen::Vector2d(reported_range_m(sensor, to.range_m),
                         direction(to, position_dim).dot(velocity_mps(to)));
}

// ∂(u · v)/∂position = (v − u (u · v)) / r
MeasurementJacobian jacobian(const SensorModel& sensor, const Viewpoint& /*from*/,
                             const SightLine& to, int position_dim) {
  const Eigen::Vector3d u = direction(to, position_dim);
  const Eigen::Vector3d v_mps = velocity_mps(to);
  const Eigen::Vector3d across = (v_mps - u * u.dot(v_mps)) / to.range_m;
  MeasurementJacobian H = MeasurementJacobian::Zero(2, position_dim);
  H.row(0) = range_row(sensor, to, position_dim);
  H.row(1) = across.head(position_dim).transpose();
  return H;
}

MeasurementJacobian velocity_jacobian(const SensorModel& /*sensor*/, const Viewpoint& /*from*/,
                                      const SightLine& to) {
  MeasurementJacobian H = MeasurementJacobian::Zero(2, 2);
  H.row(1) = direction(to, 2).head<2>().transpose();
  return H;
}

MeasurementVector variances(const SensorModel& sensor, const Viewpoint& /*from*/,
                            const SightLine& to, int /*position_dim*/) {
  return Eigen::Vector2d(square(sensor.range_sigma_m) * variance_growth(sensor, to.range_m),
                         rate_variance(sensor, to.range_m));
}

// The rows (u, 0) and (v⊥ / r, u) are orthogonal, so λ_max is the larger of their two strengths.
double bound(const SensorModel& sensor, const ReachedDistances& reached) {
  const double by_range = range_information(sensor, reached);
  if (!reached.speed_mps) {
    return by_range;
  }
  const double speed_mps = *reached.speed_mps;
  if (speed_mps > 0.0 && reached.range_near_m <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double turn_radps = speed_mps > 0.0 ? speed_mps / reached.range_near_m : 0.0;
  return std::max(by_range,
                  (1.0 + square(turn_radps)) / rate_variance(sensor, reached.range_near_m));
}

}  // namespace

constinit const SensorLaw range_rate = [] {
  SensorLaw law = law_of("range_rate", two_rows, observe, jacobian, variances, bound);
  law.parameters = kParameters;
  law.measures_range = true;
  law.velocity_jacobian = velocity_jacobian;
  return law;
}();

}  // namespace vantage::models::sensor_kinds
