#include "experiments/tracking/bearing_noise.hpp"

#include <algorithm>
#include <cmath>

#include "models/sensor/law.hpp"

namespace vantage::experiments {
namespace {

using models::SensorKind;
using models::SensorModel;

double square(double x) { return x * x; }

models::MeasurementVector variances(const SensorModel& sensor, const models::Viewpoint& from,
                                    const models::SightLine& to, int /*position_dim*/) {
  const double edge_rad = models::has_full_view(sensor) ? kPi : 0.5 * sensor.fov_rad;
  const double growth =
      std::max(sensor.variance_floor, std::abs(models::bearing_rad(from, to)) / edge_rad);
  return Eigen::Vector2d(square(sensor.range_sigma_m) * models::variance_growth(sensor, to.range_m),
                         square(sensor.bearing_sigma_rad) * growth);
}

// The viewpoints include all headings, so every target can be at the bearing of least variance.
double bound(const SensorModel& sensor, const models::ReachedDistances& reached) {
  SensorModel constant = sensor;
  constant.variance_grows_with_range = false;
  return std::max(SensorKind::kRange.law().information_bound(sensor, reached),
                  SensorKind::kBearing.law().information_bound(constant, reached) /
                      std::min(1.0, sensor.variance_floor));
}

}  // namespace

models::SensorKind range_bearing_by_bearing() {
  static const models::SensorLaw kLaw = [] {
    models::SensorLaw law = SensorKind::kRangeBearing.law();
    law.name = "range_bearing_by_bearing";
    law.variances = variances;
    law.information_bound = bound;
    law.planar_law = nullptr;
    return law;
  }();
  return SensorKind(kLaw);
}

}  // namespace vantage::experiments
