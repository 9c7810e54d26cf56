#include "drivers/vicon/object_stream_session.hpp"

#include <utility>

#include "wire/vicon/identify.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::vicon {
namespace {

void set_body(SeenBody& body, const wire::vicon::TrackerObject& object, bool is_y_up) {
  body.name = object.name();
  const bool is_zero = object.translation_mm.isZero(0.0) && object.euler_xyz_rad.isZero(0.0);
  std::optional<Quaternion> rotation;
  if (object.euler_xyz_rad.allFinite()) {
    rotation = wire::vicon::rotation_from_euler_xyz(object.euler_xyz_rad).normalized();
  }
  set_pose(body, kMetresPerMillimetre * object.translation_mm, rotation, is_zero, is_y_up);
}

}  // namespace

ObjectStreamSession::ObjectStreamSession(bool is_y_up, FrameSink sink)
    : is_y_up_(is_y_up), assembly_(std::move(sink)) {
  block_.objects.reserve(wire::vicon::kObjectsMax);
}

void ObjectStreamSession::open(Moment /*now*/) {
  assembly_.clear();
  last_number_.reset();
  outgoing.clear();
}

bool ObjectStreamSession::receive(Moment arrival, wire::vicon::Bytes datagram) {
  const bool is_block = wire::vicon::decode_object_block(datagram, block_);
  if (!is_block || block_.objects.empty() || block_.is_truncated) {
    // A packet of a DataStream may also look like a valid start of a frame.
    const wire::vicon::ServerType server_type = wire::vicon::identify_datagram(datagram);
    if (server_type == wire::vicon::ServerType::kDataStream ||
        server_type == wire::vicon::ServerType::kVrpn) {
      ++counts.broken_streams;
      return false;
    }
  }
  if (!is_block) {
    ++counts.broken_streams;
    return true;
  }
  counts.broken_blocks += block_.is_truncated ? 1 : 0;
  if (block_.is_truncated && block_.objects.empty()) {
    return true;  // noise, not counted as a frame
  }
  const bool is_continued = last_number_ == block_.frame_number;
  if (is_continued && !assembly_.is_open()) {
    // The frame was assumed complete. The missing bodies are published one frame late; the
    // following frames wait for them.
    bool is_late = false;
    for (const wire::vicon::TrackerObject& object : block_.objects) {
      if (!assembly_.frame().has(object.name())) {
        assembly_.expect_late(object.name());
        is_late = true;
      }
    }
    counts.late_blocks += is_late ? 1 : 0;
    counts.duplicate_blocks += is_late ? 0 : 1;
    return true;
  }
  SeenFrame& frame = is_continued ? assembly_.frame() : assembly_.begin(arrival);
  frame.number = block_.frame_number;
  last_number_ = block_.frame_number;
  for (const wire::vicon::TrackerObject& object : block_.objects) {
    if (!frame.has(object.name())) {
      set_body(frame.add(), object, is_y_up_);
    }
  }
  assembly_.pass_on_if_complete();
  return true;
}

Duration ObjectStreamSession::next_wake() const {
  return assembly_.next_wake().value_or(Duration::max());
}

}  // namespace vantage::drivers::vicon
