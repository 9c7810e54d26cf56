#include <algorithm>

#include "bus/convert/convert_parts.hpp"

// The robots' own motion and poses: ODOMETRY_R, SIGHTINGS_R and POSE_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

constexpr std::size_t kIncrementsMax = 256;
constexpr std::size_t kSightingsMax = 256;
constexpr std::int64_t kIncrementMaxUs = 10'000'000;
constexpr double kRangeMaxM = 1e4;

bool is_motion(const Eigen::Vector3d& motion) {
  return motion.allFinite() && motion.cwiseAbs().maxCoeff() <= kRateMax;
}

template <class Wire>
void matrix_to(const Eigen::Matrix3d& M, Wire& rows) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      rows[row][column] = M(row, column);
    }
  }
}

std::optional<Eigen::Matrix3d> covariance_from(const double (&wire)[3][3]) {
  Rows rows(3);
  for (std::size_t row = 0; row < 3; ++row) {
    rows[row].assign(std::begin(wire[row]), std::end(wire[row]));
  }
  const auto M = definite_from(rows, 3);
  return M ? std::optional<Eigen::Matrix3d>(*M) : std::nullopt;
}

std::optional<models::Sighting> sighting_from(const vantage_lcm::sighting_t& wire) {
  if (!is_utime(wire.utime) || wire.id < models::kNoTargetId ||
      !are_finite(wire.range_m, wire.bearing_rad) || wire.range_m <= 0.0 ||
      wire.range_m > kRangeMaxM || std::abs(wire.bearing_rad) > kPi) {
    return std::nullopt;
  }
  return models::Sighting{from_utime(wire.utime), wire.id, wire.range_m, wire.bearing_rad};
}

vantage_lcm::sighting_t sighting_to(const models::Sighting& sighting) {
  vantage_lcm::sighting_t wire{};
  wire.utime = to_utime(sighting.time);
  wire.id = sighting.id;
  wire.range_m = sighting.range_m;
  wire.bearing_rad = sighting.bearing_rad;
  return wire;
}

/// Appends the sightings of `wire`. Returns false if one is impossible or out of order.
template <class Wire>
bool sightings_from(const Wire& wire, std::vector<models::Sighting>& sightings) {
  if (!is_count(wire.num_sightings, wire.sightings.size(), kSightingsMax)) {
    return false;
  }
  sightings.reserve(wire.sightings.size());
  for (const vantage_lcm::sighting_t& each : wire.sightings) {
    const auto sighting = sighting_from(each);
    if (!sighting || (!sightings.empty() && sighting->time < sightings.back().time)) {
      return false;
    }
    sightings.push_back(*sighting);
  }
  return true;
}

template <class Wire>
void sightings_to(const std::vector<models::Sighting>& sightings, Wire& wire) {
  wire.num_sightings = count_of(sightings.size());
  wire.sightings.reserve(sightings.size());
  for (const models::Sighting& each : sightings) {
    wire.sightings.push_back(sighting_to(each));
  }
}

}  // namespace

vantage_lcm::odometry_t to_wire(const models::OdometryReport& odometry) {
  auto wire = stamped<vantage_lcm::odometry_t>(odometry.stamp);
  wire.robot = odometry.robot;
  wire.kind = static_cast<std::int32_t>(odometry.kind);
  wire.interval_us = odometry.interval.count();
  std::copy_n(odometry.motion_body.data(), 3, wire.motion_body);
  matrix_to(odometry.covariance, wire.covariance_motion);
  return wire;
}

std::optional<models::OdometryReport> from_wire(const vantage_lcm::odometry_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto kind = enumerator_from(wire.kind, models::OdometryKind::kCommand);
  const auto covariance = covariance_from(wire.covariance_motion);
  const Eigen::Vector3d motion(wire.motion_body[0], wire.motion_body[1], wire.motion_body[2]);
  if (!stamp || !kind || !covariance || !is_text(wire.robot) || !is_motion(motion)) {
    return std::nullopt;
  }
  const bool is_interval = *kind == models::OdometryKind::kCommand
                               ? wire.interval_us == 0
                               : wire.interval_us > 0 && wire.interval_us <= kIncrementMaxUs;
  if (!is_interval) {
    return std::nullopt;
  }
  return models::OdometryReport{*stamp, wire.robot, *kind, Duration{wire.interval_us},
                                motion, *covariance};
}

vantage_lcm::sightings_t to_wire(const models::SightingReport& report) {
  auto wire = stamped<vantage_lcm::sightings_t>(report.stamp);
  wire.robot = report.robot;
  sightings_to(report.sightings, wire);
  return wire;
}

std::optional<models::SightingReport> from_wire(const vantage_lcm::sightings_t& wire) {
  const auto stamp = stamp_from(wire);
  models::SightingReport report;
  if (!stamp || !is_text(wire.robot) || !sightings_from(wire, report.sightings)) {
    return std::nullopt;
  }
  report.stamp = *stamp;
  report.robot = wire.robot;
  return report;
}

vantage_lcm::pose_estimate_t to_wire(const models::PoseEstimate& estimate) {
  auto wire = stamped<vantage_lcm::pose_estimate_t>(estimate.stamp);
  wire.robot = estimate.robot;
  wire.source = static_cast<std::int32_t>(estimate.source);
  wire.x_world_m = estimate.world_from_body.x_m;
  wire.y_world_m = estimate.world_from_body.y_m;
  wire.yaw_world_rad = estimate.world_from_body.yaw_rad;
  matrix_to(estimate.covariance, wire.covariance_pose);
  wire.age_s = estimate.age_s;
  wire.increments_from_utime = to_utime(estimate.increments_from);
  wire.increment_us = estimate.increment.count();
  wire.num_increments = count_of(estimate.increments.size());
  wire.increments.reserve(estimate.increments.size());
  for (const Eigen::Vector3d& each : estimate.increments) {
    vantage_lcm::pose_increment_t increment{};
    increment.forward_m = each.x();
    increment.left_m = each.y();
    increment.turn_rad = each.z();
    wire.increments.push_back(increment);
  }
  wire.step = estimate.step;
  sightings_to(estimate.sightings, wire);
  inputs_to(estimate.inputs, wire);
  return wire;
}

std::optional<models::PoseEstimate> from_wire(const vantage_lcm::pose_estimate_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto source = enumerator_from(wire.source, models::PoseSource::kLocalizer);
  const auto pose = pose2_from(wire.x_world_m, wire.y_world_m, wire.yaw_world_rad);
  const auto covariance = covariance_from(wire.covariance_pose);
  if (!stamp || !source || !pose || !covariance || !is_text(wire.robot) ||
      !are_finite(wire.age_s) || wire.age_s < 0.0 || !is_utime(wire.increments_from_utime) ||
      wire.increment_us <= 0 || wire.increment_us > kIncrementMaxUs ||
      !is_count(wire.num_increments, wire.increments.size(), kIncrementsMax) || wire.step < 0) {
    return std::nullopt;
  }
  models::PoseEstimate estimate{*stamp,
                                wire.robot,
                                *source,
                                *pose,
                                *covariance,
                                wire.age_s,
                                from_utime(wire.increments_from_utime),
                                Duration{wire.increment_us},
                                {},
                                {},
                                wire.step,
                                {}};
  estimate.increments.reserve(wire.increments.size());
  for (const vantage_lcm::pose_increment_t& each : wire.increments) {
    const Eigen::Vector3d increment(each.forward_m, each.left_m, each.turn_rad);
    if (!is_motion(increment)) {
      return std::nullopt;
    }
    estimate.increments.push_back(increment);
  }
  const auto inputs = inputs_from(wire);
  if (!sightings_from(wire, estimate.sightings) || !inputs) {
    return std::nullopt;
  }
  estimate.inputs = *inputs;
  return estimate;
}

}  // namespace vantage::bus
