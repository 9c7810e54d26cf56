#include "models/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "models/sensor/law.hpp"

namespace vantage::models {
namespace {

constexpr double kFullTurnSlack_rad = 1e-9;  // 360° in degrees may be rounded below 2π

constexpr double square(double x) { return x * x; }

int dim_of(const PositionVector& position) { return static_cast<int>(position.rows()); }

/// Returns the position in a state of a TargetModel.
PositionVector position_of(const StateVector& target) {
  return target.head(target.rows() == 3 ? 3 : 2);
}

SightLine sight_line(const Viewpoint& from, const PositionVector& target_world_m,
                     const Eigen::Vector2d& velocity_world_mps) {
  SightLine to = models::sight_line(from, target_world_m);
  to.velocity_world_mps = velocity_world_mps;
  return to;
}

}  // namespace

double distance_m(const Viewpoint& a, const Viewpoint& b) {
  const Eigen::Vector2d level_m = a.world_from_body.position_m() - b.world_from_body.position_m();
  return std::hypot(level_m.norm(), a.height_m - b.height_m);
}

double own_parameter(const SensorModel& sensor, int i) {
  const double value = sensor.own[index(i)];
  return std::isnan(value) ? sensor.kind.law().parameters[index(i)].initial : value;
}

std::optional<int> find_parameter(SensorKind kind, std::string_view name) {
  const std::span<const SensorParameter> all = kind.law().parameters;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) {
      return static_cast<int>(i);
    }
  }
  return std::nullopt;
}

std::string_view words_of(ParameterRule rule) {
  return rule == ParameterRule::kAny           ? "finite"
         : rule == ParameterRule::kAtLeastZero ? "at least 0"
                                               : "above 0";
}

bool is_allowed(ParameterRule rule, double value) {
  const bool fits = rule == ParameterRule::kAny ||
                    (rule == ParameterRule::kAtLeastZero ? value >= 0.0 : value > 0.0);
  return fits && std::isfinite(value);
}

const SensorParameter* broken_parameter(const SensorModel& sensor) {
  const std::span<const SensorParameter> all = sensor.kind.law().parameters;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!is_allowed(all[i].rule, own_parameter(sensor, static_cast<int>(i)))) {
      return &all[i];
    }
  }
  return nullptr;
}

SightLine sight_line(const Viewpoint& from, const PositionVector& target_world_m) {
  const bool in_space = target_world_m.rows() == 3;
  const Eigen::Vector2d d = target_world_m.head<2>() - from.world_from_body.position_m();
  const double dz = (in_space ? target_world_m(2) : 0.0) - from.height_m;
  const double horizontal_m = d.norm();
  return {{d.x(), d.y(), dz}, horizontal_m, in_space ? std::hypot(horizontal_m, dz) : horizontal_m};
}

double bearing_rad(const Viewpoint& from, const SightLine& to) {
  return wrap_to_pi(std::atan2(to.offset_world_m.y(), to.offset_world_m.x()) -
                    from.world_from_body.yaw_rad);
}

double variance_growth(const SensorModel& sensor, double range_m) {
  return sensor.variance_grows_with_range
             ? std::max(sensor.variance_floor, range_m / sensor.range_max_m)
             : 1.0;
}

bool has_full_view(const SensorModel& sensor) {
  return sensor.fov_rad >= 2.0 * kPi - kFullTurnSlack_rad;
}

int SensorModel::measurement_dim(int position_dim) const {
  return kind.law().measurement_dim(position_dim);
}

bool in_view(const SensorModel& sensor, const Viewpoint& from,
             const PositionVector& target_world_m) {
  const Eigen::Vector2d d = target_world_m.head<2>() - from.world_from_body.position_m();
  const double range2_max_m2 = square(sensor.range_max_m);
  if (d.squaredNorm() > range2_max_m2 * (1.0 + 1e-12)) {
    return false;  // fast exit for most targets
  }
  const SensorLaw& law = sensor.kind.law();
  const SightLine to = sight_line(from, target_world_m);
  if (!(to.range_m < sensor.range_max_m) || to.range_m < sensor.range_min_m) {
    return false;
  }
  if (law.measures_range && to.range_m < kLeastRange_m) {
    return false;
  }
  if (!has_full_view(sensor) && !(std::abs(bearing_rad(from, to)) < 0.5 * sensor.fov_rad)) {
    return false;
  }
  return law.can_measure == nullptr || law.can_measure(sensor, from, to);
}

bool measures_velocity(const SensorModel& sensor) {
  return sensor.kind.law().velocity_jacobian != nullptr;
}

Eigen::Vector2d velocity_of(const StateVector& target) {
  return target.rows() == 4 ? Eigen::Vector2d(target.tail<2>()) : Eigen::Vector2d::Zero();
}

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target_world_m,
                          const Eigen::Vector2d& velocity_world_mps) {
  return sensor.kind.law().observe(
      sensor, from, sight_line(from, target_world_m, velocity_world_mps), dim_of(target_world_m));
}

MeasurementVector observe_state(const SensorModel& sensor, const Viewpoint& from,
                                const StateVector& target) {
  return observe(sensor, from, position_of(target), velocity_of(target));
}

MeasurementMatrix noise_covariance(const SensorModel& sensor, const Viewpoint& from,
                                   const PositionVector& target_world_m) {
  return sensor.kind.law()
      .variances(sensor, from, sight_line(from, target_world_m), dim_of(target_world_m))
      .asDiagonal();
}

MeasurementJacobian observation_jacobian(const SensorModel& sensor, const Viewpoint& from,
                                         const PositionVector& target_world_m,
                                         const Eigen::Vector2d& velocity_world_mps) {
  return sensor.kind.law().jacobian(
      sensor, from, sight_line(from, target_world_m, velocity_world_mps), dim_of(target_world_m));
}

MeasurementJacobian state_jacobian(const SensorModel& sensor, const Viewpoint& from,
                                   const StateVector& target) {
  const SensorLaw& law = sensor.kind.law();
  const PositionVector position_m = position_of(target);
  const SightLine to = sight_line(from, position_m, velocity_of(target));
  const MeasurementJacobian by_position = law.jacobian(sensor, from, to, dim_of(position_m));
  MeasurementJacobian H = MeasurementJacobian::Zero(by_position.rows(), target.rows());
  H.leftCols(by_position.cols()) = by_position;
  if (law.velocity_jacobian != nullptr && target.rows() == 4) {
    H.rightCols(2) = law.velocity_jacobian(sensor, from, to);
  }
  return H;
}

MeasurementVector innovation(const SensorModel& sensor, const MeasurementVector& z,
                             const MeasurementVector& z_expected) {
  MeasurementVector difference = z - z_expected;
  if (sensor.kind.law().measures_bearing) {
    double& angle_rad = difference(difference.rows() - 1);
    angle_rad = wrap_to_pi(angle_rad);
  }
  return difference;
}

PositionMatrix information(const SensorModel& sensor, const Viewpoint& from,
                           const PositionVector& target_world_m) {
  const Eigen::Index position_dim = target_world_m.rows();
  PositionMatrix M = PositionMatrix::Zero(position_dim, position_dim);
  if (!in_view(sensor, from, target_world_m)) {
    return M;
  }
  const MeasurementJacobian H = observation_jacobian(sensor, from, target_world_m);
  const MeasurementMatrix V = noise_covariance(sensor, from, target_world_m);
  for (Eigen::Index row = 0; row < H.rows(); ++row) {  // V is diagonal for every sensor kind
    M += H.row(row).transpose() * H.row(row) / V(row, row);
  }
  return M;
}

StateMatrix state_information(const SensorModel& sensor, const Viewpoint& from,
                              const StateVector& target) {
  StateMatrix M = StateMatrix::Zero(target.rows(), target.rows());
  const PositionVector position_m = position_of(target);
  if (!measures_velocity(sensor)) {
    M.topLeftCorner(position_m.rows(), position_m.rows()) = information(sensor, from, position_m);
    return M;
  }
  if (!in_view(sensor, from, position_m)) {
    return M;
  }
  const MeasurementJacobian H = state_jacobian(sensor, from, target);
  const MeasurementMatrix V = noise_covariance(sensor, from, position_m);
  for (Eigen::Index row = 0; row < H.rows(); ++row) {  // V is diagonal for every sensor kind
    M += H.row(row).transpose() * H.row(row) / V(row, row);
  }
  return M;
}

double information_bound(const SensorModel& sensor, const Viewpoint& from, double reach_m,
                         const PositionVector& target_world_m, std::optional<double> speed_mps) {
  const SightLine to = sight_line(from, target_world_m);
  const bool in_space = target_world_m.rows() == 3;
  const double dz_m = in_space ? to.offset_world_m.z() : 0.0;
  // Smallest and largest distance over the disc, rounded outwards.
  ReachedDistances reached;
  reached.horizontal_near_m = std::max(0.0, to.horizontal_m - reach_m - kLeastRange_m);
  reached.horizontal_far_m = to.horizontal_m + reach_m + kLeastRange_m;
  reached.range_near_m = std::max(sensor.range_min_m, std::hypot(reached.horizontal_near_m, dz_m));
  reached.drop_m = -to.offset_world_m.z();
  reached.position_dim = dim_of(target_world_m);
  reached.speed_mps = speed_mps;
  if (reached.range_near_m >= sensor.range_max_m ||
      std::hypot(reached.horizontal_far_m, dz_m) < sensor.range_min_m) {
    return 0.0;
  }
  return sensor.kind.law().information_bound(sensor, reached);
}

Measurement sample(const SensorModel& sensor, const Viewpoint& from,
                   const PositionVector& target_world_m, std::mt19937_64& rng,
                   const Eigen::Vector2d& velocity_world_mps) {
  Measurement measurement{observe(sensor, from, target_world_m, velocity_world_mps),
                          noise_covariance(sensor, from, target_world_m)};
  std::normal_distribution<double> unit_normal;
  for (Eigen::Index row = 0; row < measurement.z.rows(); ++row) {
    measurement.z(row) += std::sqrt(measurement.V(row, row)) * unit_normal(rng);
  }
  if (sensor.kind.law().measures_bearing) {
    double& angle_rad = measurement.z(measurement.z.rows() - 1);
    angle_rad = wrap_to_pi(angle_rad);
  }
  return measurement;
}

std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim) {
  const auto invert = sensor.kind.law().position_from;
  return invert == nullptr ? std::nullopt : invert(sensor, from, z, position_dim);
}

}  // namespace vantage::models
