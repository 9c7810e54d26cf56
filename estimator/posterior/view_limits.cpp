#include "estimator/posterior/view_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/sensor/law.hpp"

namespace vantage::estimator {
namespace {

/// Returns Φ(clearance / sigma): the probability that the target is inside one limit of the view.
double within(double clearance, double sigma) {
  if (!(std::abs(clearance) < kViewCertain_sigma * sigma)) {
    return clearance > 0.0 ? 1.0 : 0.0;
  }
  return 0.5 * std::erfc(-clearance / (std::sqrt(2.0) * sigma));
}

}  // namespace

LimitSoftness limit_softness(const models::SensorModel& sensor,
                             const models::MeasurementMatrix& V) {
  const models::SensorLaw& law = sensor.kind.law();
  const auto share = [&](Eigen::Index row) { return kSoftShare * std::sqrt(V(row, row)); };
  LimitSoftness softness;
  const bool has_own_limits =
      law.can_measure != nullptr && !law.measures_bearing && law.depth_per_m == nullptr;
  if (has_own_limits) {
    return softness;
  }
  if (law.measures_range || law.is_linear) {
    softness.distance_m = share(0);
  }
  if (law.measures_bearing) {
    softness.angle_rad = share(V.rows() - 1);
  } else if (law.depth_per_m != nullptr) {
    softness.angle_rad = share(0) / sensor.focal_length_pixels;
  }
  return softness;
}

double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        double range_m, double horizontal_m, double bearing_rad, double depth_m) {
  if (!(depth_m > 0.0)) {
    return 0.0;
  }
  const double near_m = sensor.kind.law().measures_bearing ? horizontal_m : range_m;
  double probability = within(sensor.range_max_m - range_m, softness.distance_m) *
                       within(depth_m - sensor.depth_min_m, softness.distance_m);
  if (sensor.range_min_m > 0.0) {
    probability *= within(near_m - sensor.range_min_m, softness.distance_m);
  }
  if (probability > 0.0 && !models::has_full_view(sensor)) {
    const double sideways_rad = softness.distance_m / std::max(horizontal_m, models::kLeastRange_m);
    probability *= within(0.5 * sensor.fov_rad - std::abs(wrap_to_pi(bearing_rad)),
                          std::hypot(softness.angle_rad, sideways_rad));
  }
  return probability;
}

double view_probability(const models::SensorModel& sensor, const LimitSoftness& softness,
                        const models::Viewpoint& from, const models::PositionVector& target_m) {
  const models::SensorLaw& law = sensor.kind.law();
  if (softness.distance_m <= 0.0 && softness.angle_rad <= 0.0) {
    return models::in_view(sensor, from, target_m) ? 1.0 : 0.0;
  }
  const Eigen::Vector2d off_m = target_m.head<2>() - from.world_from_body.position_m();
  const double reach_m = sensor.range_max_m + kViewCertain_sigma * softness.distance_m;
  if (off_m.squaredNorm() > reach_m * reach_m) {
    return 0.0;  // early exit for most targets
  }
  const models::SightLine to = models::sight_line(from, target_m);
  if (law.measures_range && to.range_m < models::kLeastRange_m) {
    return 0.0;
  }
  const double bearing_rad = models::bearing_rad(from, to);
  double depth_m = std::numeric_limits<double>::infinity();
  if (law.depth_per_m != nullptr) {
    const double distance_m = to.offset_world_m.norm();
    depth_m = distance_m * law.depth_per_m(sensor, bearing_rad, to.horizontal_m / distance_m,
                                           to.offset_world_m.z() / distance_m);
  }
  return view_probability(sensor, softness, to.range_m, to.horizontal_m, bearing_rad, depth_m);
}

}  // namespace vantage::estimator
