#include "bus/convert/convert_parts.hpp"

// Poses of bodies: VICON and TRUTH.

namespace vantage::bus {

using namespace parts;  // NOLINT(google-build-using-namespace): names of the converters

vantage_lcm::mocap_frame_t to_wire(const models::MocapFrame& frame) {
  vantage_lcm::mocap_frame_t wire{};
  stamp_to(frame.stamp, wire);
  wire.arrival_utime = to_utime(frame.arrival);
  wire.frame_number = frame.frame_number;
  wire.num_bodies = count_of(frame.bodies.size());
  wire.bodies.resize(frame.bodies.size());
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const models::MocapBody& body = frame.bodies[i];
    wire.bodies[i].name = body.name;
    pose3_to(body.world_from_body, wire.bodies[i].position_world_m, wire.bodies[i].quaternion_wxyz);
    wire.bodies[i].occluded = body.occluded ? 1 : 0;
  }
  return wire;
}

std::optional<models::MocapFrame> from_wire(const vantage_lcm::mocap_frame_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !is_utime(wire.arrival_utime) || !is_count(wire.num_bodies, wire.bodies.size())) {
    return std::nullopt;
  }
  models::MocapFrame frame{*stamp, from_utime(wire.arrival_utime), wire.frame_number, {}};
  frame.bodies.reserve(wire.bodies.size());
  for (const vantage_lcm::mocap_body_t& body : wire.bodies) {
    auto pose = pose3_from(body.position_world_m, body.quaternion_wxyz);
    if (!is_text(body.name) || !is_boolean(body.occluded) || (!pose && body.occluded == 0)) {
      return std::nullopt;
    }
    // The pose of an occluded body is meaningless. An invalid pose is replaced, so that it is not
    // forwarded.
    frame.bodies.push_back({body.name, pose.value_or(Pose3{}), body.occluded != 0});
  }
  return frame;
}

vantage_lcm::truth_t to_wire(const models::TruthFrame& truth) {
  vantage_lcm::truth_t wire{};
  stamp_to(truth.stamp, wire);
  wire.num_bodies = count_of(truth.bodies.size());
  wire.bodies.resize(truth.bodies.size());
  for (std::size_t i = 0; i < truth.bodies.size(); ++i) {
    const models::TruthBody& body = truth.bodies[i];
    wire.bodies[i].name = body.name;
    wire.bodies[i].target_id = body.target_id;
    pose3_to(body.world_from_body, wire.bodies[i].position_world_m, wire.bodies[i].quaternion_wxyz);
    for (int axis = 0; axis < 3; ++axis) {
      wire.bodies[i].velocity_world_mps[axis] = body.velocity_world_mps(axis);
    }
  }
  return wire;
}

std::optional<models::TruthFrame> from_wire(const vantage_lcm::truth_t& wire) {
  const auto stamp = stamp_from(wire);
  if (!stamp || !is_count(wire.num_bodies, wire.bodies.size())) {
    return std::nullopt;
  }
  models::TruthFrame truth{*stamp, {}};
  truth.bodies.reserve(wire.bodies.size());
  for (const vantage_lcm::truth_body_t& body : wire.bodies) {
    const auto pose = pose3_from(body.position_world_m, body.quaternion_wxyz);
    const Eigen::Vector3d velocity(body.velocity_world_mps[0], body.velocity_world_mps[1],
                                   body.velocity_world_mps[2]);
    if (!is_text(body.name) || body.target_id < -1 || !pose || !velocity.allFinite()) {
      return std::nullopt;
    }
    truth.bodies.push_back({body.name, body.target_id, *pose, velocity});
  }
  return truth;
}

}  // namespace vantage::bus
