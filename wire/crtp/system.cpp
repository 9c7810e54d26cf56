#include "wire/crtp/system.hpp"

#include <algorithm>

#include "wire/crtp/packet_builder.hpp"

namespace vantage::wire::crtp {
namespace {

constexpr std::uint8_t kGetInfo = 0x0C;
constexpr std::uint8_t kReply = 0x80;
constexpr std::uint8_t kEmergencyStop = 3;
constexpr std::string_view kSource = "Bitcraze Crazyflie";

std::string text_of(Bytes bytes) {
  const auto end = std::ranges::find(bytes, std::uint8_t{0});
  return {bytes.begin(), end};
}

}  // namespace

Packet arm_request(bool is_to_arm) {
  return PacketBuilder(Port::kSupervisor, 1)
      .u8(static_cast<unsigned>(SupervisorCommand::kArm))
      .u8(is_to_arm ? 1 : 0)
      .packet();
}

Packet supervisor_request(SupervisorCommand command) {
  return PacketBuilder(Port::kSupervisor, 1).u8(static_cast<unsigned>(command)).packet();
}

Packet info_request() { return PacketBuilder(Port::kSupervisor, 0).u8(kGetInfo).packet(); }

Packet legacy_emergency_stop() {
  return PacketBuilder(Port::kLocalisation, 1).u8(kEmergencyStop).packet();
}

std::optional<SupervisorRequest> decode_supervisor_request(const Packet& packet) {
  SupervisorRequest out;
  if (packet.is(Port::kSupervisor, 0) && packet.size == 1 && packet.data[0] == kGetInfo) {
    out.is_info = true;
    return out;
  }
  if (packet.is(Port::kLocalisation, 1) && packet.size == 1 && packet.data[0] == kEmergencyStop) {
    out.command = SupervisorCommand::kEmergencyStop;
    return out;
  }
  if (!packet.is(Port::kSupervisor, 1) || packet.size == 0 || packet.data[0] < 1 ||
      packet.data[0] > 4) {
    return std::nullopt;
  }
  out.command = static_cast<SupervisorCommand>(packet.data[0]);
  const bool is_arm = out.command == SupervisorCommand::kArm;
  if (packet.size != (is_arm ? 2 : 1)) {
    return std::nullopt;
  }
  out.is_to_arm = is_arm && packet.data[1] != 0;
  return out;
}

Packet supervisor_reply(SupervisorCommand command, bool is_ok, bool state) {
  return PacketBuilder(Port::kSupervisor, 1)
      .u8(static_cast<unsigned>(command) | kReply)
      .u8(is_ok ? 1 : 0)
      .u8(state ? 1 : 0)
      .packet();
}

Packet info_reply(std::uint16_t bits) {
  return PacketBuilder(Port::kSupervisor, 0).u8(kGetInfo | kReply).u16(bits).packet();
}

std::optional<std::uint16_t> decode_info_reply(const Packet& packet) {
  if (!packet.is(Port::kSupervisor, 0) || packet.size != 3 ||
      packet.data[0] != (kGetInfo | kReply)) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(packet.data[1] | packet.data[2] << 8U);
}

Packet platform_request(PlatformRequest request) {
  return PacketBuilder(Port::kPlatform, 1).u8(static_cast<unsigned>(request)).packet();
}

Packet protocol_reply(std::uint32_t version) {
  return PacketBuilder(Port::kPlatform, 1).u8(0).u32(version).packet();
}

Packet platform_text_reply(PlatformRequest request, std::string_view text) {
  return PacketBuilder(Port::kPlatform, 1)
      .u8(static_cast<unsigned>(request))
      .text(text.substr(0, kPayloadMax - 1))
      .packet();
}

std::optional<std::uint32_t> decode_protocol_reply(const Packet& packet) {
  // Older firmware sends one byte.
  if (!packet.is(Port::kPlatform, 1) || packet.data[0] != 0 ||
      (packet.size != 5 && packet.size != 2)) {
    return std::nullopt;
  }
  std::uint32_t out = 0;
  for (std::size_t i = 1; i < packet.size; ++i) {
    out |= std::uint32_t{packet.data[i]} << (8U * (i - 1));
  }
  return out;
}

std::optional<std::string> decode_platform_text(const Packet& packet, PlatformRequest request) {
  if (!packet.is(Port::kPlatform, 1) || packet.size == 0 ||
      packet.data[0] != static_cast<std::uint8_t>(request) ||
      request == PlatformRequest::kProtocol) {
    return std::nullopt;
  }
  return text_of(packet.payload().subspan(1));
}

Packet echo_request(Bytes payload) {
  return PacketBuilder(Port::kLink, 0)
      .bytes(payload.first(std::min(payload.size(), kPayloadMax)))
      .packet();
}

Packet source_request() { return PacketBuilder(Port::kLink, 1).u8(0).packet(); }

Packet source_reply() {
  PacketBuilder out(Port::kLink, 1);
  out.text(kSource);
  for (std::size_t i = kSource.size(); i < kPayloadMax; ++i) {
    out.u8(0);
  }
  return out.packet();
}

std::optional<std::string> decode_console(const Packet& packet) {
  return packet.is(Port::kConsole, 0) ? std::optional(text_of(packet.payload())) : std::nullopt;
}

}  // namespace vantage::wire::crtp
