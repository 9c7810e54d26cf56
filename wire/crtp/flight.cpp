#include "wire/crtp/flight.hpp"

#include <numbers>

#include "wire/crtp/compression.hpp"
#include "wire/crtp/packet_builder.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::wire::crtp {
namespace {

using Reader = vicon::Reader<std::endian::little>;

constexpr double kMilli = 1000.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::uint8_t kExternalPose = 8;
constexpr std::uint8_t kPackedPoses = 9;
constexpr std::uint8_t kStop = 0;
constexpr std::uint8_t kFullState = 6;
constexpr std::uint8_t kPosition = 7;
constexpr std::size_t kPackedPoseBytes = 11;

bool is_rotation(const Quaternion& q) {
  return q.coeffs().allFinite() && std::abs(q.norm() - 1.0) < 1e-3;
}

void append_milli(PacketBuilder& out, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) {
    out.i16(kMilli * v(i));
  }
}

void append_f32(PacketBuilder& out, const Eigen::Vector3d& v) {
  out.f32(v.x()).f32(v.y()).f32(v.z());
}

void append_compressed(PacketBuilder& out, const Quaternion& q) {
  const auto bits = is_rotation(q) ? compress(q) : std::nullopt;
  out.check(bits.has_value()).u32(bits.value_or(0));
}

Eigen::Vector3d milli(Reader& from) {
  Eigen::Vector3d out;
  for (int i = 0; i < 3; ++i) {
    out(i) = static_cast<std::int16_t>(from.u16()) / kMilli;
  }
  return out;
}

Eigen::Vector3d f32(Reader& from) {
  Eigen::Vector3d out;
  for (int i = 0; i < 3; ++i) {
    out(i) = static_cast<double>(from.f32());
  }
  return out;
}

/// Returns `message` if all bytes of `from` were read without error.
template <class Message>
std::optional<FlightMessage> whole(const Reader& from, Message message) {
  return from.ok() && from.left() == 0 ? std::optional<FlightMessage>(std::move(message))
                                       : std::nullopt;
}

std::optional<FlightMessage> decode_localisation(const Packet& packet) {
  Reader from(packet.payload());
  if (packet.channel == 0) {
    const ExternalPosition out{f32(from)};
    return whole(from, out);
  }
  if (packet.channel != 1) {
    return std::nullopt;
  }
  const std::uint8_t kind = from.u8();
  if (kind == kExternalPose) {
    ExternalPose out;
    out.position_world_m = f32(from);
    const Eigen::Vector3d xyz = f32(from);
    out.world_from_body = Quaternion(static_cast<double>(from.f32()), xyz.x(), xyz.y(), xyz.z());
    return whole(from, out);
  }
  if (kind == kPackedPoses && from.left() > 0 && from.left() % kPackedPoseBytes == 0) {
    std::vector<PackedPose> out(from.left() / kPackedPoseBytes);
    for (PackedPose& each : out) {
      each.id = from.u8();
      each.pose.position_world_m = milli(from);
      each.pose.world_from_body = decompress(from.u32());
    }
    return whole(from, std::move(out));
  }
  return std::nullopt;
}

std::optional<FlightMessage> decode_setpoint(const Packet& packet) {
  Reader from(packet.payload());
  const std::uint8_t kind = from.u8();
  if (packet.channel == 1 && kind == 0) {
    const SetpointsEnd out{from.u32()};
    return whole(from, out);
  }
  if (packet.channel != 0 || packet.size == 0) {
    return std::nullopt;
  }
  switch (kind) {
    case kStop:
      return whole(from, StopSetpoint{});
    case kFullState: {
      FullStateSetpoint out;
      out.position_world_m = milli(from);
      out.velocity_world_mps = milli(from);
      out.acceleration_world_mps2 = milli(from);
      out.world_from_body = decompress(from.u32());
      out.rate_body_radps = milli(from);
      return whole(from, out);
    }
    case kPosition: {
      PositionSetpoint out;
      out.position_world_m = f32(from);
      out.yaw_rad = static_cast<double>(from.f32()) / kDegrees;
      return whole(from, out);
    }
    default:
      return std::nullopt;
  }
}

std::optional<FlightMessage> decode_high_level(const Packet& packet) {
  Reader from(packet.payload());
  const std::uint8_t command = from.u8();
  from.u8();  // skips the group mask
  if (packet.channel != 0) {
    return std::nullopt;
  }
  switch (static_cast<HighLevelCommand>(command)) {
    case HighLevelCommand::kStop:
      return whole(from, HighLevelStop{});
    case HighLevelCommand::kTakeOff:
    case HighLevelCommand::kLand: {
      HighLevelHeight out;
      out.is_landing = command == static_cast<std::uint8_t>(HighLevelCommand::kLand);
      out.height_m = static_cast<double>(from.f32());
      const auto yaw_rad = static_cast<double>(from.f32());
      out.yaw_rad = from.u8() == 0 ? std::optional(yaw_rad) : std::nullopt;
      out.duration_s = static_cast<double>(from.f32());
      return whole(from, out);
    }
    case HighLevelCommand::kGoTo: {
      HighLevelGoTo out;
      out.is_relative = from.u8() != 0;
      out.is_linear = from.u8() != 0;
      out.position_world_m = f32(from);
      out.yaw_rad = static_cast<double>(from.f32());
      out.duration_s = static_cast<double>(from.f32());
      return whole(from, out);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Packet> encode(const ExternalPosition& position) {
  PacketBuilder out(Port::kLocalisation, 0);
  append_f32(out, position.position_world_m);
  return out.finish();
}

std::optional<Packet> encode(const ExternalPose& pose) {
  const Quaternion& q = pose.world_from_body;
  PacketBuilder out(Port::kLocalisation, 1);
  out.u8(kExternalPose);
  append_f32(out, pose.position_world_m);
  return out.f32(q.x()).f32(q.y()).f32(q.z()).f32(q.w()).check(is_rotation(q)).finish();
}

std::optional<Packet> encode(std::span<const PackedPose> poses) {
  PacketBuilder out(Port::kLocalisation, 1);
  out.u8(kPackedPoses).check(!poses.empty() && poses.size() <= kPackedPosesMax);
  for (const PackedPose& each : poses) {
    out.u8(each.id);
    append_milli(out, each.pose.position_world_m);
    append_compressed(out, each.pose.world_from_body);
  }
  return out.finish();
}

std::optional<Packet> encode(const StopSetpoint& /*setpoint*/) {
  return PacketBuilder(Port::kSetpoint, 0).u8(kStop).finish();
}

std::optional<Packet> encode(const FullStateSetpoint& setpoint) {
  PacketBuilder out(Port::kSetpoint, 0);
  out.u8(kFullState);
  append_milli(out, setpoint.position_world_m);
  append_milli(out, setpoint.velocity_world_mps);
  append_milli(out, setpoint.acceleration_world_mps2);
  append_compressed(out, setpoint.world_from_body);
  append_milli(out, setpoint.rate_body_radps);
  return out.finish();
}

std::optional<Packet> encode(const PositionSetpoint& setpoint) {
  PacketBuilder out(Port::kSetpoint, 0);
  out.u8(kPosition);
  append_f32(out, setpoint.position_world_m);
  return out.f32(setpoint.yaw_rad * kDegrees).finish();
}

std::optional<Packet> encode(const SetpointsEnd& end) {
  return PacketBuilder(Port::kSetpoint, 1).u8(0).u32(end.valid_for_ms).finish();
}

std::optional<Packet> encode(const HighLevelStop& /*stop*/) {
  return PacketBuilder(Port::kHighLevel, 0)
      .u8(static_cast<unsigned>(HighLevelCommand::kStop))
      .u8(0)
      .finish();
}

std::optional<Packet> encode(const HighLevelHeight& command) {
  const auto number = command.is_landing ? HighLevelCommand::kLand : HighLevelCommand::kTakeOff;
  return PacketBuilder(Port::kHighLevel, 0)
      .u8(static_cast<unsigned>(number))
      .u8(0)
      .f32(command.height_m)
      .f32(command.yaw_rad.value_or(0.0))
      .u8(command.yaw_rad ? 0 : 1)
      .f32(command.duration_s)
      .check(command.duration_s >= 0.0)
      .finish();
}

std::optional<Packet> encode(const HighLevelGoTo& command) {
  PacketBuilder out(Port::kHighLevel, 0);
  out.u8(static_cast<unsigned>(HighLevelCommand::kGoTo)).u8(0);
  out.u8(command.is_relative ? 1 : 0).u8(command.is_linear ? 1 : 0);
  append_f32(out, command.position_world_m);
  return out.f32(command.yaw_rad).f32(command.duration_s).check(command.duration_s >= 0.0).finish();
}

std::optional<Packet> encode_reply(const Packet& request, std::uint8_t error) {
  PacketBuilder out(Port::kHighLevel, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    out.u8(i < request.size ? request.data[i] : 0);
  }
  return out.u8(error).finish();
}

std::optional<HighLevelReply> decode_high_level_reply(const Packet& packet) {
  if (!packet.is(Port::kHighLevel, 0) || packet.size != 4) {
    return std::nullopt;
  }
  return HighLevelReply{packet.data[0], packet.data[3]};
}

std::optional<FlightMessage> decode_flight(const Packet& packet) {
  switch (packet.port) {
    case Port::kLocalisation:
      return decode_localisation(packet);
    case Port::kSetpoint:
      return decode_setpoint(packet);
    case Port::kHighLevel:
      return decode_high_level(packet);
    default:
      return std::nullopt;
  }
}

}  // namespace vantage::wire::crtp
