#include "wire/rover/packet.hpp"

#include <bit>
#include <cmath>

#include "wire/vicon/bytes.hpp"

namespace vantage::wire::rover {
namespace {

constexpr std::uint8_t kCommandKind = 1;
constexpr std::uint8_t kTelemetryKind = 2;
constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kChecksumBytes = 4;

using Reader = vicon::Reader<std::endian::little>;

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) {
      rest = (rest & 1U) != 0 ? 0xEDB88320U ^ (rest >> 1U) : rest >> 1U;
    }
    table[byte] = rest;
  }
  return table;
}

/// Writer of numbers into a message of fixed size, with the checksum last.
template <std::size_t kBytes>
class Writer {
 public:
  explicit Writer(std::uint8_t kind) {
    number(kMagic);
    number(kProtocolVersion);
    number(kind);
  }
  template <class Unsigned>
  void number(Unsigned value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      bytes_[at_++] = static_cast<std::uint8_t>(value >> (8U * i));
    }
  }
  void number(float value) { number(std::bit_cast<std::uint32_t>(value)); }
  std::array<std::uint8_t, kBytes> finish() {
    number(crc32(std::span(bytes_).first(kBytes - kChecksumBytes)));
    return bytes_;
  }

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
  std::size_t at_ = 0;
};

/// Checks header, length and checksum of a datagram. If the datagram is accepted, sets `content` to
/// the bytes between header and checksum.
Verdict open(std::span<const std::uint8_t> datagram, std::uint8_t kind, std::size_t bytes,
             std::span<const std::uint8_t>& content) {
  Reader header(datagram);
  const std::uint16_t magic = header.u16();
  const std::uint8_t version = header.u8();
  const std::uint8_t its_kind = header.u8();
  if (!header.ok() || magic != kMagic) {
    return Verdict::kForeign;
  }
  if (version != kProtocolVersion) {
    return Verdict::kVersion;
  }
  if (its_kind != kind) {
    return Verdict::kKind;
  }
  if (datagram.size() != bytes) {
    return Verdict::kLength;
  }
  const std::size_t covered = bytes - kChecksumBytes;
  if (Reader(datagram.subspan(covered)).u32() != crc32(datagram.first(covered))) {
    return Verdict::kChecksum;
  }
  content = datagram.subspan(kHeaderBytes, covered - kHeaderBytes);
  return Verdict::kAccepted;
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = crc_table();
  std::uint32_t rest = ~0U;
  for (const std::uint8_t byte : bytes) {
    rest = kTable[(rest ^ byte) & 0xFFU] ^ (rest >> 8U);
  }
  return ~rest;
}

const char* name_of(Verdict verdict) {
  static constexpr std::array<const char*, kVerdicts> kNames = {
      "accepted", "foreign", "version", "kind", "length", "checksum", "value"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::array<std::uint8_t, kCommandBytes> encode(const Command& command) {
  Writer<kCommandBytes> out(kCommandKind);
  out.number(command.robot);
  out.number(command.session);
  out.number(command.sequence);
  out.number(static_cast<std::uint64_t>(command.time_us));
  out.number(command.speed_mps);
  out.number(command.yaw_rate_radps);
  out.number(command.flags);
  return out.finish();
}

std::array<std::uint8_t, kTelemetryBytes> encode(const Telemetry& telemetry) {
  Writer<kTelemetryBytes> out(kTelemetryKind);
  out.number(telemetry.robot);
  out.number(telemetry.boot);
  out.number(telemetry.sequence);
  out.number(telemetry.session);
  out.number(telemetry.command_sequence);
  out.number(static_cast<std::uint64_t>(telemetry.command_time_us));
  out.number(telemetry.speed_mps);
  out.number(telemetry.yaw_rate_radps);
  out.number(telemetry.battery_share);
  out.number(telemetry.flags);
  out.number(telemetry.refused);
  return out.finish();
}

Verdict decode(std::span<const std::uint8_t> datagram, Command& out) {
  std::span<const std::uint8_t> content;
  const Verdict frame = open(datagram, kCommandKind, kCommandBytes, content);
  if (frame != Verdict::kAccepted) {
    return frame;
  }
  Reader in(content);
  Command read;
  read.robot = in.u32();
  read.session = in.u32();
  read.sequence = in.u32();
  read.time_us = in.i64();
  read.speed_mps = in.f32();
  read.yaw_rate_radps = in.f32();
  read.flags = in.u32();
  if (!std::isfinite(read.speed_mps) || !std::isfinite(read.yaw_rate_radps) || read.session == 0) {
    return Verdict::kValue;
  }
  out = read;
  return Verdict::kAccepted;
}

Verdict decode(std::span<const std::uint8_t> datagram, Telemetry& out) {
  std::span<const std::uint8_t> content;
  const Verdict frame = open(datagram, kTelemetryKind, kTelemetryBytes, content);
  if (frame != Verdict::kAccepted) {
    return frame;
  }
  Reader in(content);
  Telemetry read;
  read.robot = in.u32();
  read.boot = in.u32();
  read.sequence = in.u32();
  read.session = in.u32();
  read.command_sequence = in.u32();
  read.command_time_us = in.i64();
  read.speed_mps = in.f32();
  read.yaw_rate_radps = in.f32();
  read.battery_share = in.f32();
  read.flags = in.u32();
  read.refused = in.u32();
  if (!std::isfinite(read.speed_mps) || !std::isfinite(read.yaw_rate_radps) ||
      !(read.battery_share >= 0.0F && read.battery_share <= 1.0F)) {
    return Verdict::kValue;
  }
  out = read;
  return Verdict::kAccepted;
}

}  // namespace vantage::wire::rover
