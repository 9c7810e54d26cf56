#include "sim/vicon/vrpn_peer.hpp"

#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

// Type numbers of this server.
constexpr std::int32_t kPoseType = 0;
constexpr std::int32_t kPongType = 1;
constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;

wire::vicon::VrpnPose pose_of(const Pose3& pose) {
  return {0, pose.translation_m, pose.rotation.coeffs()};  // both Eigen and VRPN order x, y, z, w
}

}  // namespace

VrpnPeer::VrpnPeer(const ServerSettings& settings)
    : settings_(settings), stream_(2 * wire::vicon::kVrpnMessageBytesMax) {
  wire::vicon::append_vrpn_cookie(outgoing);
}

bool VrpnPeer::receive(wire::vicon::Bytes bytes) {
  while (!bytes.empty()) {
    bytes = bytes.subspan(stream_.push(bytes));
    if (!is_greeted_) {
      if (stream_.view().size() < wire::vicon::kVrpnCookieBytes) {
        return true;
      }
      const auto version = wire::vicon::decode_vrpn_cookie(stream_.view());
      if (!version || version->major != wire::vicon::kVrpnMajor) {
        return false;
      }
      stream_.consume(wire::vicon::kVrpnCookieBytes);
      is_greeted_ = true;
      wire::vicon::append_vrpn_name(outgoing, wire::vicon::kVrpnTypeDescription, kPoseType,
                                    wire::vicon::kVrpnPoseType);
      wire::vicon::append_vrpn_name(outgoing, wire::vicon::kVrpnTypeDescription, kPongType,
                                    wire::vicon::kVrpnPongType);
    }
    for (;;) {
      wire::vicon::VrpnHeader header;
      const wire::vicon::Framed message = wire::vicon::next_vrpn_message(stream_.view(), header);
      if (message.state == wire::vicon::Framing::kBroken) {
        return false;
      }
      if (message.state == wire::vicon::Framing::kNeedMore) {
        break;
      }
      on_message(header, message.body);
      stream_.consume(message.bytes);
    }
  }
  return true;
}

std::int32_t VrpnPeer::sender_of(const std::string& name) {
  const auto [entry, is_new] =
      senders_.try_emplace(name, static_cast<std::int32_t>(senders_.size()));
  if (is_new) {
    wire::vicon::append_vrpn_name(outgoing, wire::vicon::kVrpnSenderDescription, entry->second,
                                  name);
  }
  return entry->second;
}

void VrpnPeer::on_message(const wire::vicon::VrpnHeader& header, wire::vicon::Bytes payload) {
  const bool is_sender = header.type == wire::vicon::kVrpnSenderDescription;
  if (is_sender || header.type == wire::vicon::kVrpnTypeDescription) {
    auto& names = is_sender ? client_senders_ : client_types_;
    const auto name = wire::vicon::decode_vrpn_name(payload);
    if (name && names.size() < kNamesMax) {
      names[header.sender] = std::string(*name);
    }
    return;
  }
  const auto type = client_types_.find(header.type);
  const auto sender = client_senders_.find(header.sender);
  if (type == client_types_.end() || type->second != wire::vicon::kVrpnPingType ||
      sender == client_senders_.end() || outgoing.size() > settings_.backlog_bytes_max) {
    return;
  }
  if (const auto own = senders_.find(sender->second); own != senders_.end()) {
    wire::vicon::append_vrpn_message(outgoing, {0, 0, own->second, kPongType}, {});
  }
}

void VrpnPeer::on_frame(const EmulatedFrame& frame) {
  if (!is_greeted_) {
    return;
  }
  if (outgoing.size() > settings_.backlog_bytes_max) {
    ++frames_skipped;
    return;
  }
  for (const EmulatedBody& body : frame.bodies) {
    sender_of(body.name);
  }
  const std::int64_t stamp_us = to_utime(frame.captured);
  for (const EmulatedBody& body : frame.bodies) {
    wire::vicon::VrpnPose pose;
    if (!body.is_occluded) {
      pose = pose_of(settings_.is_y_up ? wire::vicon::y_up_from_z_up(body.world_from_body)
                                       : body.world_from_body);
      last_seen_[body.name] = pose;
    } else if (settings_.occlusion == OcclusionStyle::kAbsent) {
      continue;
    } else if (settings_.occlusion == OcclusionStyle::kRepeated) {
      pose = last_seen_.try_emplace(body.name, pose).first->second;
    }
    const wire::vicon::VrpnHeader header{
        static_cast<std::uint32_t>(stamp_us / kMicrosecondsPerSecond),
        static_cast<std::uint32_t>(stamp_us % kMicrosecondsPerSecond), sender_of(body.name),
        kPoseType};
    wire::vicon::append_vrpn_pose(outgoing, header, pose);
  }
  ++frames_sent;
}

}  // namespace vantage::sim::vicon
