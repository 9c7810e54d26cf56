#include "sim/vicon/natnet_peer.hpp"

#include <algorithm>

#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

using wire::natnet::PacketId;

constexpr Duration kChangedFor = std::chrono::seconds(1);
/// Time from the arrival of the images to the sending of the frame, as recorded with Motive 2.1.
constexpr double kComputation_s = 0.0009;

std::uint64_t ticks_at(Duration time) {
  return static_cast<std::uint64_t>(time.count()) * (NatNetPeer::kTicksPerSecond / 1'000'000);
}

}  // namespace

NatNetPeer::NatNetPeer(const ServerSettings& settings, bool is_group)
    : settings_(settings),
      version_{{settings.natnet_version[0], settings.natnet_version[1], 0, 0}},
      is_connected_(is_group) {}

bool NatNetPeer::receive(wire::vicon::Bytes datagram) {
  const auto packet = wire::natnet::decode_packet(datagram);
  if (!packet) {
    return false;
  }
  switch (packet->id) {
    case PacketId::kConnect:
    case PacketId::kDiscovery: {
      if (!wire::natnet::decode_connect(packet->payload)) {
        return false;
      }
      is_connected_ = is_connected_ || packet->id == PacketId::kConnect;
      wire::natnet::ServerInfo info;
      info.name = "vantage";
      info.application = {{1, 0, 0, 0}};
      info.natnet = version_;
      info.ticks_per_s = kTicksPerSecond;
      info.data_port = settings_.data_port > 0 ? settings_.data_port : info.data_port;
      info.is_multicast = settings_.is_multicast;
      append_server_info(outgoing, info);
      return true;
    }
    case PacketId::kDefinitionsRequest:
      append_definitions(outgoing, version_, definitions_);
      return true;
    case PacketId::kEchoRequest:
      if (const auto stamp = wire::natnet::decode_echo_request(packet->payload)) {
        wire::natnet::append_echo_response(outgoing, {*stamp, ticks_at(now)});
        return true;
      }
      return false;
    case PacketId::kRequest:
      if (wire::natnet::decode_request(packet->payload) == "FrameRate") {
        wire::natnet::append_response(outgoing, static_cast<float>(settings_.rate_hz));
      } else {
        append_empty(outgoing, PacketId::kUnknownRequest);
      }
      return true;
    case PacketId::kDisconnect:
      is_connected_ = false;
      return true;
    case PacketId::kKeepAlive:
      return true;
    default:
      append_empty(outgoing, PacketId::kUnknownRequest);
      return true;
  }
}

void NatNetPeer::define(const EmulatedFrame& frame) {
  const bool is_same = std::ranges::equal(definitions_, frame.bodies, {},
                                          &wire::natnet::BodyDefinition::name, &EmulatedBody::name);
  if (is_same) {
    return;
  }
  definitions_.clear();
  for (const EmulatedBody& body : frame.bodies) {
    definitions_.push_back({static_cast<std::int32_t>(definitions_.size() + 1), body.name});
  }
  changed_until_ = now + kChangedFor;
}

void NatNetPeer::on_frame(const EmulatedFrame& frame) {
  define(frame);
  if (!is_connected_) {
    return;
  }
  frame_.number = frame.number;
  frame_.bodies.clear();
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const EmulatedBody& body = frame.bodies[i];
    wire::natnet::RigidBody& out = last_[body.name];
    out.id = definitions_[i].id;
    out.is_tracked = !body.is_occluded;
    if (out.is_tracked) {
      const Pose3 pose = settings_.is_y_up ? wire::vicon::y_up_from_z_up(body.world_from_body)
                                           : body.world_from_body;
      out.position_m = pose.translation_m.cast<float>();
      out.rotation_xyzw = pose.rotation.coeffs().cast<float>();
      out.mean_error_m = 0.0002F;
    }
    frame_.bodies.push_back(out);
  }
  frame_.since_start_s = to_seconds(now);
  frame_.sent_ticks = ticks_at(now);
  frame_.exposed_ticks = ticks_at(now - from_seconds(frame.latency_s));
  frame_.received_ticks = ticks_at(now - from_seconds(std::min(frame.latency_s, kComputation_s)));
  frame_.flags = now < changed_until_ ? wire::natnet::kFlagDefinitionsChanged : 0;
  append_frame(outgoing, version_, frame_);
  ++frames_sent;
}

}  // namespace vantage::sim::vicon
