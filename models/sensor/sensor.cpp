#include "models/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// Camera frame: x right, y down, z along the optical axis, which is tilted down from body x.

namespace vantage::models {
namespace {

constexpr double kLeastRange_m = 1e-9;       // nearer, ranges and bearings have no direction
constexpr double kFullTurnSlack_rad = 1e-9;  // 360° given in degrees may round below 2π

bool has_range(SensorKind kind) {
  return kind == SensorKind::kRange || kind == SensorKind::kRangeBearing;
}
bool has_bearing(SensorKind kind) {
  return kind == SensorKind::kBearing || kind == SensorKind::kRangeBearing;
}

double square(double x) { return x * x; }

// The line from the sensor to the target.
struct Sight {
  Eigen::Vector3d offset_world_m;  // z: true height difference, also for planar targets
  double horizontal_m;
  double range_m;      // horizontal for planar targets, in space for others
  double bearing_rad;  // from body x, wrapped
};

Sight sight(const Viewpoint& from, const PositionVector& target_world_m) {
  const bool in_space = target_world_m.rows() == 3;
  const Eigen::Vector2d d = target_world_m.head<2>() - from.world_from_body.position_m();
  const double dz = (in_space ? target_world_m(2) : 0.0) - from.height_m;
  const double horizontal_m = d.norm();
  return {{d.x(), d.y(), dz},
          horizontal_m,
          in_space ? std::hypot(horizontal_m, dz) : horizontal_m,
          wrap_to_pi(std::atan2(d.y(), d.x()) - from.world_from_body.yaw_rad)};
}

// Rows: camera x, y, z in the level body frame.
Eigen::Matrix3d camera_from_body(double tilt_rad) {
  const double c = std::cos(tilt_rad);
  const double s = std::sin(tilt_rad);
  Eigen::Matrix3d R;
  R << 0.0, -1.0, 0.0,  //
      -s, 0.0, -c,      //
      c, 0.0, -s;
  return R;
}

Eigen::Matrix3d body_from_world(const Viewpoint& from) {
  const double c = std::cos(from.world_from_body.yaw_rad);
  const double s = std::sin(from.world_from_body.yaw_rad);
  Eigen::Matrix3d R;
  R << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return R;
}

Eigen::Matrix3d camera_from_world(const SensorModel& sensor, const Viewpoint& from) {
  return camera_from_body(sensor.camera_tilt_rad) * body_from_world(from);
}

// Factor on range and bearing variances at `range_m`.
double variance_growth(const SensorModel& sensor, double range_m) {
  return sensor.variance_grows_with_range
             ? std::max(sensor.variance_floor, range_m / sensor.range_max_m)
             : 1.0;
}

double camera_bound(const SensorModel& sensor, double height_m, double nearest_m, double farthest_m,
                    const PositionVector& target_world_m) {
  const bool in_space = target_world_m.rows() == 3;
  const double drop_m = height_m - (in_space ? target_world_m(2) : 0.0);
  const double c = std::cos(sensor.camera_tilt_rad);
  const double s = std::sin(sensor.camera_tilt_rad);
  // depth = c ρ cos β + s · drop is bilinear in ρ and cos β: extreme at the corners of their box.
  const double least_cos =
      sensor.fov_rad >= 2.0 * kPi - kFullTurnSlack_rad ? -1.0 : std::cos(0.5 * sensor.fov_rad);
  double depth_min_m = std::numeric_limits<double>::infinity();
  double depth_max_m = -depth_min_m;
  for (const double rho_m : {nearest_m, farthest_m}) {
    for (const double cos_bearing : {least_cos, 1.0}) {
      const double depth_m = c * rho_m * cos_bearing + s * drop_m;
      depth_min_m = std::min(depth_min_m, depth_m);
      depth_max_m = std::max(depth_max_m, depth_m);
    }
  }
  if (depth_max_m + kLeastRange_m < sensor.depth_min_m) {
    return 0.0;
  }
  const double depth_m = std::max(sensor.depth_min_m, depth_min_m - kLeastRange_m);
  if (depth_m <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double distance2_m2 = square(farthest_m) + square(drop_m);
  double gain = distance2_m2 / square(square(depth_m));
  if (!in_space) {
    // Moves in the plane change depth by |c| at most: ‖P v‖ ≤ 1/d + ‖q_⊥‖ |c| / d². Exact for a
    // camera that looks straight down, where the other bound is (‖q‖/d)² times too large.
    const double across_m = std::sqrt(std::max(0.0, distance2_m2 - square(depth_m)));
    gain = std::min(gain, square((1.0 + across_m * std::abs(c) / depth_m) / depth_m));
  }
  return square(sensor.focal_length_pixels / sensor.pixel_sigma) * gain;
}

}  // namespace

int SensorModel::measurement_dim(int position_dim) const {
  switch (kind) {
    case SensorKind::kPosition:
      return position_dim;
    case SensorKind::kRange:
    case SensorKind::kBearing:
      return 1;
    case SensorKind::kRangeBearing:
    case SensorKind::kCamera:
      return 2;
  }
  return 0;
}

bool in_view(const SensorModel& sensor, const Viewpoint& from,
             const PositionVector& target_world_m) {
  const Eigen::Vector2d d = target_world_m.head<2>() - from.world_from_body.position_m();
  const double range2_max_m2 = square(sensor.range_max_m);
  if (d.squaredNorm() > range2_max_m2 * (1.0 + 1e-12)) {
    return false;  // the cheap way out for most targets
  }
  const Sight to = sight(from, target_world_m);
  if (!(to.range_m < sensor.range_max_m) || to.range_m < sensor.range_min_m) {
    return false;
  }
  if (has_range(sensor.kind) && to.range_m < kLeastRange_m) {
    return false;
  }
  if (has_bearing(sensor.kind) && to.horizontal_m < std::max(sensor.range_min_m, kLeastRange_m)) {
    return false;
  }
  if (sensor.fov_rad < 2.0 * kPi - kFullTurnSlack_rad &&
      !(std::abs(to.bearing_rad) < 0.5 * sensor.fov_rad)) {
    return false;
  }
  if (sensor.kind == SensorKind::kCamera) {
    const double depth_m =
        std::cos(sensor.camera_tilt_rad) * to.horizontal_m * std::cos(to.bearing_rad) -
        std::sin(sensor.camera_tilt_rad) * to.offset_world_m.z();
    return depth_m > 0.0 && depth_m >= sensor.depth_min_m;
  }
  return true;
}

MeasurementVector observe(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target_world_m) {
  const Sight to = sight(from, target_world_m);
  const double reported_m =
      sensor.calibration.range_scale * to.range_m + sensor.calibration.range_bias_m;
  switch (sensor.kind) {
    case SensorKind::kPosition: {
      const Eigen::Vector3d target_body_m = body_from_world(from) * to.offset_world_m;
      return target_body_m.head(target_world_m.rows());
    }
    case SensorKind::kRange:
      return Eigen::Matrix<double, 1, 1>(reported_m);
    case SensorKind::kBearing:
      return Eigen::Matrix<double, 1, 1>(to.bearing_rad);
    case SensorKind::kRangeBearing:
      return Eigen::Vector2d(reported_m, to.bearing_rad);
    case SensorKind::kCamera: {
      const Eigen::Vector3d q = camera_from_world(sensor, from) * to.offset_world_m;
      return sensor.focal_length_pixels / q.z() * q.head<2>();
    }
  }
  return {};
}

MeasurementMatrix noise_covariance(const SensorModel& sensor, const Viewpoint& from,
                                   const PositionVector& target_world_m) {
  const int rows = sensor.measurement_dim(static_cast<int>(target_world_m.rows()));
  MeasurementMatrix V = MeasurementMatrix::Zero(rows, rows);
  const auto growth = [&] { return variance_growth(sensor, sight(from, target_world_m).range_m); };
  switch (sensor.kind) {
    case SensorKind::kPosition:
      V.diagonal().setConstant(square(sensor.position_sigma_m));
      break;
    case SensorKind::kRange:
      V(0, 0) = square(sensor.range_sigma_m) * growth();
      break;
    case SensorKind::kBearing:
      V(0, 0) = square(sensor.bearing_sigma_rad) * growth();
      break;
    case SensorKind::kRangeBearing: {
      const double factor = growth();
      V(0, 0) = square(sensor.range_sigma_m) * factor;
      V(1, 1) = square(sensor.bearing_sigma_rad) * factor;
      break;
    }
    case SensorKind::kCamera:
      V.diagonal().setConstant(square(sensor.pixel_sigma));
      break;
  }
  return V;
}

MeasurementJacobian observation_jacobian(const SensorModel& sensor, const Viewpoint& from,
                                         const PositionVector& target_world_m) {
  const Sight to = sight(from, target_world_m);
  const Eigen::Index position_dim = target_world_m.rows();
  const int rows = sensor.measurement_dim(static_cast<int>(position_dim));
  MeasurementJacobian H = MeasurementJacobian::Zero(rows, position_dim);
  if (has_range(sensor.kind)) {
    H.row(0) = sensor.calibration.range_scale / to.range_m *
               to.offset_world_m.head(position_dim).transpose();
  }
  if (has_bearing(sensor.kind)) {
    const double rho2 = square(to.horizontal_m);
    H(rows - 1, 0) = -to.offset_world_m.y() / rho2;
    H(rows - 1, 1) = to.offset_world_m.x() / rho2;
  }
  if (sensor.kind == SensorKind::kPosition) {
    H = body_from_world(from).topLeftCorner(position_dim, position_dim);
  }
  if (sensor.kind == SensorKind::kCamera) {
    const Eigen::Matrix3d R = camera_from_world(sensor, from);
    const Eigen::Vector3d q = R * to.offset_world_m;
    Eigen::Matrix<double, 2, 3> projection;                  // π'(q)
    projection << 1.0 / q.z(), 0.0, -q.x() / square(q.z()),  //
        0.0, 1.0 / q.z(), -q.y() / square(q.z());
    const Eigen::Matrix<double, 2, 3> H_space = sensor.focal_length_pixels * projection * R;
    H = H_space.leftCols(position_dim);
  }
  return H;
}

MeasurementVector innovation(const SensorModel& sensor, const MeasurementVector& z,
                             const MeasurementVector& z_expected) {
  MeasurementVector difference = z - z_expected;
  if (has_bearing(sensor.kind)) {
    double& bearing_rad = difference(difference.rows() - 1);
    bearing_rad = wrap_to_pi(bearing_rad);
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
  for (Eigen::Index row = 0; row < H.rows(); ++row) {  // V is diagonal for every sensor here
    M += H.row(row).transpose() * H.row(row) / V(row, row);
  }
  return M;
}

double information_bound(const SensorModel& sensor, const Viewpoint& from, double reach_m,
                         const PositionVector& target_world_m) {
  const Sight to = sight(from, target_world_m);
  const bool in_space = target_world_m.rows() == 3;
  const double dz_m = in_space ? to.offset_world_m.z() : 0.0;
  // Horizontal distances that the disc offers, rounded outwards.
  const double nearest_m = std::max(0.0, to.horizontal_m - reach_m - kLeastRange_m);
  const double farthest_m = to.horizontal_m + reach_m + kLeastRange_m;
  const double range_near_m = std::max(sensor.range_min_m, std::hypot(nearest_m, dz_m));
  if (range_near_m >= sensor.range_max_m || std::hypot(farthest_m, dz_m) < sensor.range_min_m) {
    return 0.0;
  }
  const double growth = variance_growth(sensor, range_near_m);
  const double range_information =
      square(sensor.calibration.range_scale / sensor.range_sigma_m) / growth;
  switch (sensor.kind) {
    case SensorKind::kPosition:
      return 1.0 / square(sensor.position_sigma_m);
    case SensorKind::kRange:
      return range_information;
    case SensorKind::kBearing:
    case SensorKind::kRangeBearing: {
      const double rho_m = std::max(sensor.range_min_m, nearest_m);
      if (farthest_m < sensor.range_min_m) {
        return 0.0;
      }
      // 1 / 0 is the +∞ that a bearing sensor without a least range deserves.
      const double bearing_information =
          rho_m > 0.0 ? 1.0 / (square(sensor.bearing_sigma_rad * rho_m) * growth)
                      : std::numeric_limits<double>::infinity();
      // Range and bearing inform about orthogonal directions: the larger one is λ_max.
      return sensor.kind == SensorKind::kBearing ? bearing_information
                                                 : std::max(range_information, bearing_information);
    }
    case SensorKind::kCamera: {
      const double horizontal_max_m =
          in_space ? std::sqrt(square(sensor.range_max_m) - square(dz_m)) : sensor.range_max_m;
      return camera_bound(sensor, from.height_m, nearest_m, std::min(farthest_m, horizontal_max_m),
                          target_world_m);
    }
  }
  return 0.0;
}

Measurement sample(const SensorModel& sensor, const Viewpoint& from,
                   const PositionVector& target_world_m, std::mt19937_64& rng) {
  Measurement measurement{observe(sensor, from, target_world_m),
                          noise_covariance(sensor, from, target_world_m)};
  std::normal_distribution<double> unit_normal;
  for (Eigen::Index row = 0; row < measurement.z.rows(); ++row) {
    measurement.z(row) += std::sqrt(measurement.V(row, row)) * unit_normal(rng);
  }
  if (has_bearing(sensor.kind)) {
    double& bearing_rad = measurement.z(measurement.z.rows() - 1);
    bearing_rad = wrap_to_pi(bearing_rad);
  }
  return measurement;
}

std::optional<PositionVector> position_from(const SensorModel& sensor, const Viewpoint& from,
                                            const MeasurementVector& z, int position_dim) {
  const Pose2& world_from_body = from.world_from_body;
  PositionVector target_world_m = PositionVector::Zero(position_dim);
  switch (sensor.kind) {
    case SensorKind::kRange:
    case SensorKind::kBearing:
      return std::nullopt;
    case SensorKind::kPosition: {
      const Eigen::Vector2d target_body_m = z.head<2>();
      target_world_m.head<2>() = world_from_body * target_body_m;
      if (position_dim == 3) {
        target_world_m(2) = from.height_m + z(2);
      }
      return target_world_m;
    }
    case SensorKind::kRangeBearing: {
      const double range_m =
          (z(0) - sensor.calibration.range_bias_m) / sensor.calibration.range_scale;
      const double drop_m = position_dim == 3 ? from.height_m : 0.0;
      if (!(range_m >= 0.0) || range_m < std::abs(drop_m)) {
        return std::nullopt;
      }
      const double rho_m = std::sqrt(square(range_m) - square(drop_m));
      const Eigen::Vector2d target_body_m(rho_m * std::cos(z(1)), rho_m * std::sin(z(1)));
      target_world_m.head<2>() = world_from_body * target_body_m;
      return target_world_m;
    }
    case SensorKind::kCamera: {
      const double f = sensor.focal_length_pixels;
      const Eigen::Vector3d ray_world =
          camera_from_world(sensor, from).transpose() * Eigen::Vector3d(z(0) / f, z(1) / f, 1.0);
      const double depth_m = -from.height_m / ray_world.z();
      if (!(depth_m > 0.0) || !std::isfinite(depth_m)) {
        return std::nullopt;
      }
      target_world_m.head<2>() = world_from_body.position_m() + depth_m * ray_world.head<2>();
      return target_world_m;
    }
  }
  return std::nullopt;
}

}  // namespace vantage::models
