#include "models/sensor/kinds/kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vantage::models {

constinit const SensorKind SensorKind::kPosition(sensor_kinds::position);
constinit const SensorKind SensorKind::kRange(sensor_kinds::range);
constinit const SensorKind SensorKind::kBearing(sensor_kinds::bearing);
constinit const SensorKind SensorKind::kRangeBearing(sensor_kinds::range_bearing);
constinit const SensorKind SensorKind::kCamera(sensor_kinds::camera);
constinit const SensorKind SensorKind::kRangeRate(sensor_kinds::range_rate);

std::span<const SensorKind> all_sensor_kinds() {
  static constexpr std::array kAll{
      SensorKind(sensor_kinds::position), SensorKind(sensor_kinds::range),
      SensorKind(sensor_kinds::bearing),  SensorKind(sensor_kinds::range_bearing),
      SensorKind(sensor_kinds::camera),   SensorKind(sensor_kinds::range_rate),
  };
  return kAll;
}

std::string_view SensorKind::name() const { return law_->name; }

namespace sensor_kinds {

Eigen::Matrix3d body_from_world(const Viewpoint& from) {
  const double c = std::cos(from.world_from_body.yaw_rad);
  const double s = std::sin(from.world_from_body.yaw_rad);
  Eigen::Matrix3d R;
  R << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return R;
}

double reported_range_m(const SensorModel& sensor, double range_m) {
  return sensor.calibration.range_scale * range_m + sensor.calibration.range_bias_m;
}

Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> range_row(const SensorModel& sensor,
                                                                          const SightLine& to,
                                                                          int position_dim) {
  return sensor.calibration.range_scale / to.range_m *
         to.offset_world_m.head(position_dim).transpose();
}

Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> bearing_row(const SightLine& to,
                                                                            int position_dim) {
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3> row =
      Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 3>::Zero(1, position_dim);
  const double rho2 = square(to.horizontal_m);
  row(0) = -to.offset_world_m.y() / rho2;
  row(1) = to.offset_world_m.x() / rho2;
  return row;
}

bool has_bearing(const SensorModel& sensor, const SightLine& to) {
  return to.horizontal_m >= std::max(sensor.range_min_m, kLeastRange_m);
}

double range_information(const SensorModel& sensor, const ReachedDistances& reached) {
  return square(sensor.calibration.range_scale / sensor.range_sigma_m) /
         variance_growth(sensor, reached.range_near_m);
}

double bearing_information(const SensorModel& sensor, const ReachedDistances& reached) {
  if (reached.horizontal_far_m < sensor.range_min_m) {
    return 0.0;
  }
  const double rho_m = std::max(sensor.range_min_m, reached.horizontal_near_m);
  // A bearing sensor without a minimum range has unbounded information above the target: +∞.
  return rho_m > 0.0 ? 1.0 / (square(sensor.bearing_sigma_rad * rho_m) *
                              variance_growth(sensor, reached.range_near_m))
                     : std::numeric_limits<double>::infinity();
}

}  // namespace sensor_kinds
}  // namespace vantage::models
