#include "wire/natnet/packet.hpp"

#include <algorithm>

namespace vantage::wire::natnet {
namespace {

constexpr std::size_t kHeaderBytes = 4;

Version read_version(Reader& from) {
  Version out;
  for (std::uint8_t& part : out.parts) {
    part = from.u8();
  }
  return out;
}

void write_version(Writer& to, const Version& version) {
  for (const std::uint8_t part : version.parts) {
    to.u8(part);
  }
}

/// Returns the text up to the first NUL. Servers do not clear the bytes after it.
std::string read_name(Reader& from) {
  const std::string_view bytes = from.text(kNameBytes);
  return std::string(bytes.substr(0, bytes.find('\0')));
}

void write_name(Writer& to, std::string_view name) {
  const std::string_view cut = name.substr(0, std::min(name.size(), kNameBytes - 1));
  to.text(cut);
  to.zeros(kNameBytes - cut.size());
}

}  // namespace

std::string to_text(const Version& version) {
  return std::to_string(version.parts[0]) + "." + std::to_string(version.parts[1]);
}

std::optional<Packet> decode_packet(Bytes datagram) {
  Reader from(datagram);
  const auto id = static_cast<PacketId>(from.u16());
  const std::size_t size = from.u16();
  const Bytes payload = from.take(size);
  return from.ok() ? std::optional(Packet{id, payload}) : std::nullopt;
}

PacketWriter::PacketWriter(std::vector<std::uint8_t>& out, PacketId id)
    : out_(out), begin_(out.size()), writer_(out) {
  writer_.u16(static_cast<std::uint16_t>(id));
  writer_.u16(0);
}

bool PacketWriter::finish() {
  const std::size_t size = out_.size() - begin_ - kHeaderBytes;
  if (size > kPayloadBytesMax) {
    out_.resize(begin_);
    return false;
  }
  out_[begin_ + 2] = static_cast<std::uint8_t>(size & 0xFFU);
  out_[begin_ + 3] = static_cast<std::uint8_t>(size >> 8U);
  return true;
}

void append_empty(std::vector<std::uint8_t>& out, PacketId id) { PacketWriter(out, id).finish(); }

void append_connect(std::vector<std::uint8_t>& out, PacketId id, const Connect& connect) {
  PacketWriter packet(out, id);
  write_name(packet.write(), connect.name);
  write_version(packet.write(), connect.application);
  write_version(packet.write(), connect.natnet);
  if (connect.natnet.parts[0] >= 4) {
    packet.write().u8(connect.is_subscriber ? 1 : 0);
    write_version(packet.write(), connect.bitstream);
  }
  packet.finish();
}

std::optional<Connect> decode_connect(Bytes payload) {
  Reader from(payload);
  Connect out;
  out.name = read_name(from);
  out.application = read_version(from);
  out.natnet = read_version(from);
  if (!from.ok()) {
    return std::nullopt;
  }
  if (from.left() > 0) {
    out.is_subscriber = from.u8() != 0;
    out.bitstream = read_version(from);
  }
  return from.ok() ? std::optional(out) : std::nullopt;
}

void append_server_info(std::vector<std::uint8_t>& out, const ServerInfo& info) {
  PacketWriter packet(out, PacketId::kServerInfo);
  write_name(packet.write(), info.name);
  write_version(packet.write(), info.application);
  write_version(packet.write(), info.natnet);
  packet.write().u64(info.ticks_per_s);
  packet.write().u16(info.data_port);
  packet.write().u8(info.is_multicast ? 1 : 0);
  for (const std::uint8_t part : info.group) {
    packet.write().u8(part);
  }
  packet.finish();
}

std::optional<ServerInfo> decode_server_info(Bytes payload) {
  Reader from(payload);
  ServerInfo out;
  out.name = read_name(from);
  out.application = read_version(from);
  out.natnet = read_version(from);
  out.ticks_per_s = from.u64();
  out.data_port = from.u16();
  out.is_multicast = from.u8() != 0;
  for (std::uint8_t& part : out.group) {
    part = from.u8();
  }
  return from.ok() ? std::optional(out) : std::nullopt;
}

void append_request(std::vector<std::uint8_t>& out, std::string_view command) {
  PacketWriter packet(out, PacketId::kRequest);
  packet.write().text(command);
  packet.write().u8(0);
  packet.finish();
}

std::optional<std::string_view> decode_request(Bytes payload) {
  Reader from(payload);
  const std::string_view command = from.terminated_text();
  return from.ok() ? std::optional(command) : std::nullopt;
}

void append_response(std::vector<std::uint8_t>& out, float value) {
  PacketWriter packet(out, PacketId::kResponse);
  packet.write().f32(value);
  packet.finish();
}

std::optional<float> decode_response(Bytes payload) {
  Reader from(payload);
  const float value = from.f32();
  return from.ok() ? std::optional(value) : std::nullopt;
}

void append_echo_request(std::vector<std::uint8_t>& out, std::uint64_t stamp) {
  PacketWriter packet(out, PacketId::kEchoRequest);
  packet.write().u64(stamp);
  packet.finish();
}

std::optional<std::uint64_t> decode_echo_request(Bytes payload) {
  Reader from(payload);
  const std::uint64_t stamp = from.u64();
  return from.ok() ? std::optional(stamp) : std::nullopt;
}

void append_echo_response(std::vector<std::uint8_t>& out, const EchoResponse& response) {
  PacketWriter packet(out, PacketId::kEchoResponse);
  packet.write().u64(response.stamp);
  packet.write().u64(response.server_ticks);
  packet.finish();
}

std::optional<EchoResponse> decode_echo_response(Bytes payload) {
  Reader from(payload);
  EchoResponse out;
  out.stamp = from.u64();
  out.server_ticks = from.u64();
  return from.ok() ? std::optional(out) : std::nullopt;
}

}  // namespace vantage::wire::natnet
