#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wire/vicon/bytes.hpp"

// Packets of OptiTrack's NatNet protocol, versions 3.0 to 4.x: one datagram is one packet. Numbers
// are little-endian. Layout of frames and definitions: frame.hpp, definitions.hpp.
// Source: public decoders (python_natnet, natnet_py) and the datagrams recorded by python_natnet.

namespace vantage::wire::natnet {

using vicon::Bytes;
using Reader = vicon::Reader<std::endian::little>;
using Writer = vicon::Writer<std::endian::little>;

inline constexpr int kDataPort = 1511;  ///< default source and destination port of frames
inline constexpr std::size_t kNameBytes = 256;
inline constexpr std::size_t kVectorBytes = 12;          ///< three 32-bit numbers
inline constexpr std::size_t kPayloadBytesMax = 65'503;  ///< bytes; limit of OptiTrack's library

/// Meaning of a packet.
enum class PacketId : std::uint16_t {
  kConnect = 0,
  kServerInfo = 1,
  kRequest = 2,
  kResponse = 3,
  kDefinitionsRequest = 4,
  kDefinitions = 5,
  kFrame = 7,
  kText = 8,
  kDisconnect = 9,
  kKeepAlive = 10,
  kEchoRequest = 12,
  kEchoResponse = 13,
  kDiscovery = 14,
  kUnknownRequest = 100,
};

/// Version of an application or of the protocol: major, minor, build, revision.
struct Version {
  std::array<std::uint8_t, 4> parts{};
  friend auto operator<=>(const Version&, const Version&) = default;
};

inline constexpr Version kVersionMin{{3, 0, 0, 0}};  ///< older layouts are not read
/// First version whose sections and definitions contain their size in bytes.
inline constexpr Version kSizedSince{{4, 1, 0, 0}};

/// Returns "4.1".
std::string to_text(const Version& version);

struct Packet {
  PacketId id = PacketId::kUnknownRequest;
  Bytes payload;
};

/// Returns the packet in a datagram; nullopt if the datagram is shorter than its header states.
std::optional<Packet> decode_packet(Bytes datagram);

/// Request for a connection (kConnect), or search for servers (kDiscovery).
struct Connect {
  std::string name = "NatNetLib";  ///< name of the client, at most 255 bytes
  Version application;
  Version natnet;  ///< newest version that the client reads
  /// requested version of frames; zeros: the newest that the server supports; only since 4.0
  Version bitstream;
  bool is_subscriber = false;  ///< requests only subscribed data. Only since 4.0
};

/// Answer of a server to Connect.
struct ServerInfo {
  std::string name;
  Version application;
  Version natnet;  ///< version of all further packets
  std::uint64_t ticks_per_s = 0;
  std::uint16_t data_port = kDataPort;
  bool is_multicast = false;
  std::array<std::uint8_t, 4> group{239, 255, 42, 99};  ///< multicast address of frames
};

/// Stamp of the client, and the server's clock when the server answered.
struct EchoResponse {
  std::uint64_t stamp = 0;
  std::uint64_t server_ticks = 0;
};

// Each function appends one whole packet to `out`.
void append_empty(std::vector<std::uint8_t>& out, PacketId id);
void append_connect(std::vector<std::uint8_t>& out, PacketId id, const Connect& connect);
void append_server_info(std::vector<std::uint8_t>& out, const ServerInfo& info);
void append_request(std::vector<std::uint8_t>& out, std::string_view command);
void append_response(std::vector<std::uint8_t>& out, float value);
void append_echo_request(std::vector<std::uint8_t>& out, std::uint64_t stamp);
void append_echo_response(std::vector<std::uint8_t>& out, const EchoResponse& response);

// Each function reads the payload of one packet, and returns nullopt if it is too short.
std::optional<Connect> decode_connect(Bytes payload);
std::optional<ServerInfo> decode_server_info(Bytes payload);
std::optional<std::string_view> decode_request(Bytes payload);
std::optional<float> decode_response(Bytes payload);
std::optional<std::uint64_t> decode_echo_request(Bytes payload);
std::optional<EchoResponse> decode_echo_response(Bytes payload);

/// Appends the header of a packet in the constructor and writes its payload size in finish().
class PacketWriter {
 public:
  PacketWriter(std::vector<std::uint8_t>& out, PacketId id);
  [[nodiscard]] Writer& write() { return writer_; }
  /// Returns false, and removes the packet, if the payload is larger than kPayloadBytesMax.
  bool finish();

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t begin_;
  Writer writer_;
};

}  // namespace vantage::wire::natnet
