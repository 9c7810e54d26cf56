#include "sim/vicon/qtm_peer.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "wire/qualisys/body_names.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::sim::vicon {
namespace {

using wire::qualisys::Component;
using wire::qualisys::PacketType;

constexpr std::size_t kCommandBytesMax = std::size_t{1} << 12U;
constexpr std::uint8_t kSettingsChanged = 10;  ///< event number
constexpr std::uint8_t kConnected = 1;         ///< event number
constexpr double kDegreesPerRadian = 57.29577951308232;

constexpr std::array<std::pair<std::string_view, Component>, 4> kComponents{
    {{"6D", Component::k6D},
     {"6DEuler", Component::k6DEuler},
     {"6DRes", Component::k6DResidual},
     {"6DEulerRes", Component::k6DEulerResidual}}};

wire::qualisys::Body body_of(const EmulatedBody& body, bool is_y_up) {
  wire::qualisys::Body out;
  if (body.is_occluded) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    out.position_mm.setConstant(kNone);
    out.world_from_body.setConstant(kNone);
    out.euler_deg.setConstant(kNone);
    out.residual_mm = kNone;
    return out;
  }
  const Pose3 pose =
      is_y_up ? wire::vicon::y_up_from_z_up(body.world_from_body) : body.world_from_body;
  out.position_mm = (1e3 * pose.translation_m).cast<float>();
  out.world_from_body = pose.rotation.toRotationMatrix().cast<float>();
  out.euler_deg =
      (kDegreesPerRadian * wire::vicon::euler_xyz_from_rotation(pose.rotation)).cast<float>();
  out.residual_mm = 0.2F;
  return out;
}

}  // namespace

QtmPeer::QtmPeer(const ServerSettings& settings) : settings_(settings), stream_(kCommandBytesMax) {
  append_text(outgoing, PacketType::kCommand, "QTM RT Interface connected");
}

bool QtmPeer::receive(wire::vicon::Bytes bytes) {
  return stream_.receive(bytes, wire::qualisys::next_packet, [this](const auto& packet) {
    if (packet.type == PacketType::kCommand && outgoing.size() <= settings_.backlog_bytes_max) {
      on_command(wire::qualisys::text_of(packet.body));
    }
    return true;
  });
}

void QtmPeer::on_command(std::string_view command) {
  constexpr std::string_view kStream = "StreamFrames AllFrames ";
  if (command == "Version 1.25") {
    append_text(outgoing, PacketType::kCommand, "Version set to 1.25");
  } else if (command == "QTMVersion") {
    append_text(outgoing, PacketType::kCommand, "QTM Version is 2.17 (build 4000)");
  } else if (command == "GetState") {
    wire::qualisys::append_event(outgoing, kConnected);
  } else if (command == "GetParameters 6D") {
    append_text(outgoing, PacketType::kXml, wire::qualisys::encode_body_names(names_));
  } else if (command == "StreamFrames Stop") {
    is_streaming_ = false;
  } else if (command.starts_with(kStream)) {
    stream(command.substr(kStream.size()));
  } else {
    append_text(outgoing, PacketType::kError, "Parse error");
  }
}

void QtmPeer::stream(std::string_view components) {
  const auto found =
      std::ranges::find(kComponents, components, &std::pair<std::string_view, Component>::first);
  if (found == kComponents.end()) {
    append_text(outgoing, PacketType::kError, "Parse error");
    return;
  }
  frame_.component = found->second;
  is_streaming_ = true;
}

void QtmPeer::on_frame(const EmulatedFrame& frame) {
  if (!std::ranges::equal(names_, frame.bodies, {}, {}, &EmulatedBody::name)) {
    names_.clear();
    for (const EmulatedBody& body : frame.bodies) {
      names_.push_back(body.name);
    }
    wire::qualisys::append_event(outgoing, kSettingsChanged);
  }
  start_ = start_.value_or(frame.captured);
  if (!is_streaming_) {
    return;
  }
  if (outgoing.size() > settings_.backlog_bytes_max) {
    ++frames_skipped;
    return;
  }
  frame_.number = frame.number;
  frame_.time_us = (frame.captured - *start_).count();
  frame_.bodies.clear();
  for (const EmulatedBody& body : frame.bodies) {
    frame_.bodies.push_back(body_of(body, settings_.is_y_up));
  }
  append_frame(outgoing, frame_);
  ++frames_sent;
}

}  // namespace vantage::sim::vicon
