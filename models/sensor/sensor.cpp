#include "models/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>

#include "models/sensor/sight.hpp"

// Camera frame: x right, y down, z along the optical axis, which is tilted down from body x.

namespace vantage::models {
namespace {

using sensor_detail::bearing_rad;
using sensor_detail::has_bearing;
using sensor_detail::has_range;
using sensor_detail::kLeastRange_m;
using sensor_detail::sees_all_around;
using sensor_detail::Sight;
using sensor_detail::sight;
using sensor_detail::square;
using sensor_detail::variance_growth;

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
  if (!sees_all_around(sensor) && !(std::abs(bearing_rad(from, to)) < 0.5 * sensor.fov_rad)) {
    return false;
  }
  if (sensor.kind == SensorKind::kCamera) {
    const Eigen::Vector3d q = camera_from_world(sensor, from) * to.offset_world_m;
    const double depth_m = q.z();
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
      return Eigen::Matrix<double, 1, 1>(bearing_rad(from, to));
    case SensorKind::kRangeBearing:
      return Eigen::Vector2d(reported_m, bearing_rad(from, to));
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
  for (Eigen::Index row = 0; row < H.rows(); ++row) {  // V is diagonal for every sensor here
    M += H.row(row).transpose() * H.row(row) / V(row, row);
  }
  return M;
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
    double& angle_rad = measurement.z(measurement.z.rows() - 1);
    angle_rad = wrap_to_pi(angle_rad);
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
