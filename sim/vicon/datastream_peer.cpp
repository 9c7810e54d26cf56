#include "sim/vicon/datastream_peer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

// Contents that this server can send: static and dynamic.
constexpr std::array<std::uint32_t, 5> kStatic{
    wire::vicon::kStreamInfo, wire::vicon::kSubjectInfo, wire::vicon::kSubjectHealth,
    wire::vicon::kApplicationInfo, wire::vicon::kObjectQuality};
constexpr std::array<std::uint32_t, 7> kDynamic{
    wire::vicon::kFrameInfo,          wire::vicon::kLocalSegments,     wire::vicon::kGlobalSegments,
    wire::vicon::kLatencyInfo,        wire::vicon::kHardwareFrameInfo, wire::vicon::kFrameRateInfo,
    wire::vicon::kLightweightSegments};
constexpr std::size_t kClientPacketBytesMax = std::size_t{1} << 16U;
constexpr std::uint32_t kFramesWantedMax = 1000;
constexpr std::uint32_t kRootSegment = 1;

std::uint32_t subject_id(std::size_t index) { return static_cast<std::uint32_t>(index + 1); }

/// Tracker reports the latency of each stage; two stages suffice to test that clients add them.
wire::vicon::LatencyInfo latency_of(const EmulatedFrame& frame) {
  return {{{"Camera", 0.25 * frame.latency_s}, {"Processing", 0.75 * frame.latency_s}}};
}

}  // namespace

DataStreamPeer::DataStreamPeer(const ServerSettings& settings)
    : settings_(settings), stream_(kClientPacketBytesMax) {
  wire::vicon::ObjectEnums offered;
  offered.types.assign(kStatic.begin(), kStatic.end());
  offered.types.insert(offered.types.end(), kDynamic.begin(), kDynamic.end());
  offered.types.push_back(wire::vicon::kContents);
  std::sort(offered.types.begin(), offered.types.end());
  wire::vicon::PacketWriter packet(outgoing);
  append(packet, offered);
  packet.finish();
}

bool DataStreamPeer::receive(wire::vicon::Bytes bytes) {
  return stream_.receive(bytes, wire::vicon::next_packet, [this](const auto& packet) {
    wire::vicon::BlockCursor cursor(packet.body);
    while (const auto block = cursor.next()) {
      on_block(*block);
    }
    return !cursor.is_broken();
  });
}

void DataStreamPeer::on_block(const wire::vicon::Block& block) {
  wire::vicon::ObjectEnums enums;
  wire::vicon::RequestFrame request;
  wire::vicon::RequestNextFrame next;
  wire::vicon::Ping ping;
  if (block.type == wire::vicon::kObjectEnums && decode(block.body, enums)) {
    requested_ = enums;
    is_static_due_ = true;
  } else if (block.type == wire::vicon::kRequestFrame && decode(block.body, request)) {
    is_streaming_ = request.streaming;
    frames_wanted_ = request.streaming ? 0 : std::max(frames_wanted_, 1U);
  } else if (block.type == wire::vicon::kRequestNextFrame && decode(block.body, next)) {
    frames_wanted_ =
        std::min(frames_wanted_ + std::min(next.count, kFramesWantedMax), kFramesWantedMax);
  } else if (block.type == wire::vicon::kPing && decode(block.body, ping) &&
             outgoing.size() < settings_.backlog_bytes_max) {
    wire::vicon::PacketWriter packet(outgoing);
    append(packet, ping);
    packet.finish();
  }
}

bool DataStreamPeer::is_requested(std::uint32_t type) const {
  return std::find(requested_.types.begin(), requested_.types.end(), type) !=
         requested_.types.end();
}

bool DataStreamPeer::has_new_subjects(const EmulatedFrame& frame) {
  const bool is_same = std::equal(
      frame.bodies.begin(), frame.bodies.end(), subjects_.begin(), subjects_.end(),
      [](const EmulatedBody& body, const std::string& name) { return body.name == name; });
  if (!is_same) {
    subjects_.clear();
    for (const EmulatedBody& body : frame.bodies) {
      subjects_.push_back(body.name);
    }
  }
  return !is_same;
}

void DataStreamPeer::on_frame(const EmulatedFrame& frame) {
  if (!is_streaming_ && frames_wanted_ == 0) {
    return;
  }
  if (outgoing.size() > settings_.backlog_bytes_max) {
    ++frames_skipped;
    return;
  }
  const bool has_static = has_new_subjects(frame) || is_static_due_;
  is_static_due_ = false;
  wire::vicon::PacketWriter packet(outgoing);
  if (is_requested(wire::vicon::kContents)) {
    append_contents(packet, frame, has_static);
  }
  if (has_static) {
    append_static(packet);
  }
  append_dynamic(packet, frame);
  packet.finish();
  frames_wanted_ -= frames_wanted_ > 0 ? 1 : 0;
  ++frames_sent;
}

void DataStreamPeer::append_contents(wire::vicon::PacketWriter& packet, const EmulatedFrame& frame,
                                     bool has_static) const {
  wire::vicon::Contents contents;
  for (const std::uint32_t type : requested_.types) {
    const bool is_of_static = std::find(kStatic.begin(), kStatic.end(), type) != kStatic.end();
    const bool is_each_subject =
        type == wire::vicon::kSubjectInfo || type == wire::vicon::kObjectQuality ||
        type == wire::vicon::kSubjectHealth || type == wire::vicon::kGlobalSegments ||
        type == wire::vicon::kLocalSegments || type == wire::vicon::kLightweightSegments;
    const bool is_known =
        is_of_static || std::find(kDynamic.begin(), kDynamic.end(), type) != kDynamic.end();
    if (is_of_static && !has_static) {
      contents.unchanged.push_back(type);
    } else if (is_known) {
      const std::size_t blocks = is_each_subject ? frame.bodies.size() : 1;
      contents.sent.push_back({type, static_cast<std::uint32_t>(blocks)});
    }
  }
  append(packet, contents);
}

void DataStreamPeer::append_static(wire::vicon::PacketWriter& packet) const {
  if (is_requested(wire::vicon::kStreamInfo)) {
    append(packet, wire::vicon::StreamInfo{
                       std::llround(wire::vicon::StreamInfo::kTicksPerSecond / settings_.rate_hz)});
  }
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    if (is_requested(wire::vicon::kSubjectInfo)) {
      wire::vicon::SubjectInfo subject;
      subject.subject_id = subject_id(i);
      subject.name = subjects_[i];
      subject.segments = {{0, kRootSegment, {}, subjects_[i]}};
      append(packet, subject);
    }
    if (is_requested(wire::vicon::kSubjectHealth)) {
      append(packet, wire::vicon::SubjectHealth{subject_id(i), 0.0, 1.0});
    }
    if (is_requested(wire::vicon::kObjectQuality)) {
      append(packet, wire::vicon::ObjectQuality{subject_id(i), 1.0});
    }
  }
  if (is_requested(wire::vicon::kApplicationInfo)) {
    append(packet, wire::vicon::ApplicationInfo{settings_.is_y_up});
  }
}

void DataStreamPeer::append_dynamic(wire::vicon::PacketWriter& packet,
                                    const EmulatedFrame& frame) const {
  append(packet, wire::vicon::FrameInfo{frame.number});  // required in each frame
  if (is_requested(wire::vicon::kHardwareFrameInfo)) {
    append(packet, wire::vicon::HardwareFrameInfo{frame.number});
  }
  if (is_requested(wire::vicon::kLatencyInfo)) {
    append(packet, latency_of(frame));
  }
  if (is_requested(wire::vicon::kFrameRateInfo)) {
    append(packet, wire::vicon::FrameRateInfo{{{"System Frame Rate", settings_.rate_hz}}});
  }
  append_poses(packet, frame);
}

void DataStreamPeer::append_poses(wire::vicon::PacketWriter& packet,
                                  const EmulatedFrame& frame) const {
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const EmulatedBody& body = frame.bodies[i];
    const Pose3 pose = settings_.is_y_up ? wire::vicon::y_up_from_z_up(body.world_from_body)
                                         : body.world_from_body;
    wire::vicon::Segments segments;
    wire::vicon::LightweightSegments light;
    segments.subject_id = light.subject_id = subject_id(i);
    if (!body.is_occluded) {
      const Eigen::AngleAxisd turn(pose.rotation);
      segments.poses = {{kRootSegment, 1e3 * pose.translation_m, pose.rotation.toRotationMatrix()}};
      light.poses = {{kRootSegment, (1e3 * pose.translation_m).cast<float>(),
                      (turn.angle() * turn.axis()).cast<float>()}};
    }
    if (is_requested(wire::vicon::kGlobalSegments)) {
      append(packet, segments, wire::vicon::kGlobalSegments);
    }
    if (is_requested(wire::vicon::kLocalSegments)) {  // a root's local pose is its global pose
      append(packet, segments, wire::vicon::kLocalSegments);
    }
    if (is_requested(wire::vicon::kLightweightSegments)) {
      append(packet, light);
    }
  }
}

}  // namespace vantage::sim::vicon
