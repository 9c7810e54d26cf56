#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

// CRTP, the packet protocol of Crazyflies: one header byte and at most 30 bytes of payload,
// little-endian. Layouts are those of protocol version 12 (firmware 2026.08).
//
// A payload of another length than the firmware expects, or a number that is not finite, stops the
// firmware in flight. Therefore encoders return nullopt instead of such a packet.

namespace vantage::wire::crtp {

using Bytes = std::span<const std::uint8_t>;

inline constexpr std::size_t kPayloadMax = 30;
inline constexpr std::size_t kPacketMax = kPayloadMax + 1;

/// Service of a packet.
enum class Port : std::uint8_t {
  kConsole = 0,
  kParameter = 2,
  kRollPitchYaw = 3,
  kMemory = 4,
  kLog = 5,
  kLocalisation = 6,
  kSetpoint = 7,
  kHighLevel = 8,
  kSupervisor = 9,
  kPlatform = 13,
  kLink = 15,
};

struct Packet {
  Port port = Port::kLink;
  std::uint8_t channel = 0;  ///< in [0, 3]
  std::uint8_t size = 0;     ///< bytes of payload
  std::array<std::uint8_t, kPayloadMax> data{};

  [[nodiscard]] Bytes payload() const { return {data.data(), size}; }
  [[nodiscard]] bool is(Port of, int on) const { return port == of && channel == on; }
  friend bool operator==(const Packet& a, const Packet& b) {
    return a.port == b.port && a.channel == b.channel &&
           std::ranges::equal(a.payload(), b.payload());
  }
};

/// Packet as bytes of a datagram or a radio transmission.
struct Encoded {
  std::array<std::uint8_t, kPacketMax> data{};
  std::size_t size = 0;

  [[nodiscard]] Bytes bytes() const { return {data.data(), size}; }
};

/// Bits 2 and 3 of the header belong to the link. Clients send 1, vehicles send 0.
inline constexpr std::uint8_t kClientLinkBits = 0x0C;
/// Packet without content. A radio sends it to search for vehicles, or if it has nothing else to
/// send.
inline constexpr std::uint8_t kNullHeader = 0xFF;

/// Returns the bytes of `packet`. `link_bits` is kClientLinkBits, or 0 for a vehicle.
Encoded encode(const Packet& packet, std::uint8_t link_bits = kClientLinkBits);
/// Returns the packet in `bytes`; nullopt if there are no bytes or more than kPacketMax.
std::optional<Packet> decode(Bytes bytes);
/// True for a packet without content (kNullHeader, or port 15 channel 3 of a vehicle).
inline bool is_null(const Packet& packet) { return packet.is(Port::kLink, 3); }

}  // namespace vantage::wire::crtp
