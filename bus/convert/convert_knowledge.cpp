#include <algorithm>
#include <limits>

#include "bus/convert/convert_parts.hpp"

// Measurements and beliefs of robots: MEASUREMENT_R and BELIEF_R.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

namespace {

std::optional<models::Detection> detection_from(const vantage_lcm::detection_t& wire) {
  const bool has_shape =
      wire.dim >= 1 && wire.dim <= models::kMaxMeasurementDim && is_count(wire.dim, wire.z.size());
  const auto V = has_shape ? definite_from(wire.covariance_z, wire.dim) : std::nullopt;
  if (wire.target_id < models::kNoTargetId || !V) {
    return std::nullopt;
  }
  models::Detection detection;
  detection.target_id = wire.target_id;
  detection.measurement.z = Eigen::Map<const Eigen::VectorXd>(wire.z.data(), wire.dim);
  detection.measurement.V = *V;
  if (!detection.measurement.z.allFinite()) {
    return std::nullopt;
  }
  return detection;
}

std::optional<models::TargetBelief> target_from(const vantage_lcm::target_belief_t& wire) {
  const bool has_shape = wire.dim >= models::kMinTargetDim && wire.dim <= models::kMaxTargetDim &&
                         is_count(wire.dim, wire.information_vector.size());
  const auto Omega = has_shape ? definite_from(wire.information_matrix, wire.dim) : std::nullopt;
  if (wire.target_id < 0 || !Omega || !is_utime(wire.last_seen_utime)) {
    return std::nullopt;
  }
  models::TargetBelief target;
  target.target_id = wire.target_id;
  target.information.vector =
      Eigen::Map<const Eigen::VectorXd>(wire.information_vector.data(), wire.dim);
  target.information.matrix = *Omega;
  target.last_seen = from_utime(wire.last_seen_utime);
  if (!target.information.vector.allFinite()) {
    return std::nullopt;
  }
  return target;
}

}  // namespace

vantage_lcm::measurement_t to_wire(const models::RobotMeasurement& detections) {
  auto wire = stamped<vantage_lcm::measurement_t>(detections.stamp);
  wire.robot = detections.robot;
  viewpoint_to(detections.viewpoint, wire);
  wire.jammed = detections.jammed ? 1 : 0;
  wire.num_detections = count_of(detections.detections.size());
  wire.detections.resize(detections.detections.size());
  for (std::size_t i = 0; i < detections.detections.size(); ++i) {
    const models::Detection& detection = detections.detections[i];
    const models::MeasurementVector& z = detection.measurement.z;
    const int dim = static_cast<int>(z.size());
    wire.detections[i].target_id = detection.target_id;
    wire.detections[i].dim = dim;
    wire.detections[i].z.assign(z.data(), z.data() + dim);
    wire.detections[i].covariance_z = rows_to(detection.measurement.V, dim);
  }
  inputs_to(detections.inputs, wire);
  return wire;
}

std::optional<models::RobotMeasurement> from_wire(const vantage_lcm::measurement_t& wire) {
  const auto stamp = stamp_from(wire);
  const auto viewpoint = viewpoint_from(wire);
  auto inputs = inputs_from(wire);
  if (!stamp || !viewpoint || !inputs || !is_text(wire.robot) || !is_boolean(wire.jammed) ||
      !is_count(wire.num_detections, wire.detections.size())) {
    return std::nullopt;
  }
  models::RobotMeasurement set{*stamp,           wire.robot, *viewpoint,
                               wire.jammed != 0, {},         std::move(*inputs)};
  set.detections.reserve(wire.detections.size());
  for (const vantage_lcm::detection_t& each : wire.detections) {
    const auto detection = detection_from(each);
    if (!detection) {
      return std::nullopt;
    }
    set.detections.push_back(*detection);
  }
  return set;
}

vantage_lcm::belief_t to_wire(const models::RobotBelief& belief) {
  auto wire = with_step_head<vantage_lcm::belief_t>(belief, belief.last_seen_utime.size());
  wire.degree = belief.degree;
  wire.num_targets = count_of(belief.targets.size());
  wire.targets.resize(belief.targets.size());
  for (std::size_t i = 0; i < belief.targets.size(); ++i) {
    const models::TargetBelief& target = belief.targets[i];
    const models::StateVector& omega = target.information.vector;
    const int dim = static_cast<int>(omega.size());
    wire.targets[i].target_id = target.target_id;
    wire.targets[i].dim = dim;
    wire.targets[i].information_vector.assign(omega.data(), omega.data() + dim);
    wire.targets[i].information_matrix = rows_to(target.information.matrix, dim);
    wire.targets[i].last_seen_utime = to_utime(target.last_seen);
  }
  wire.last_seen_utime = belief.last_seen_utime;
  return wire;
}

std::optional<models::RobotBelief> from_wire(const vantage_lcm::belief_t& wire) {
  auto head = step_head_from(wire, wire.last_seen_utime.size());
  if (!head || wire.degree < 0 || !is_count(wire.num_targets, wire.targets.size()) ||
      !std::all_of(wire.last_seen_utime.begin(), wire.last_seen_utime.end(), is_utime)) {
    return std::nullopt;
  }
  models::RobotBelief belief;
  belief.stamp = head->stamp;
  belief.robot = wire.robot;
  belief.step = wire.step;
  belief.viewpoint = head->viewpoint;
  belief.degree = wire.degree;
  belief.targets.reserve(wire.targets.size());
  int previous_id = -1;
  for (const vantage_lcm::target_belief_t& each : wire.targets) {
    const auto target = target_from(each);
    if (!target || target->target_id <= previous_id) {
      return std::nullopt;  // receivers rely on ascending ids
    }
    previous_id = target->target_id;
    belief.targets.push_back(*target);
  }
  belief.grid = head->grid;
  belief.last_seen_utime = wire.last_seen_utime;
  belief.inputs = std::move(head->inputs);
  return belief;
}

}  // namespace vantage::bus
