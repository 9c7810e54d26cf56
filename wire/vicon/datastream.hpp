#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wire/vicon/bytes.hpp"
#include "wire/vicon/stream_buffer.hpp"

// Framing of Vicon's DataStream (CGStream), TCP port 801, little-endian and packed:
//   packet := u32 0x1A2B0001 | u32 bytes that follow | block*
//   block  := u32 type | u32 bytes of body | body
// Both directions use this format.

namespace vantage::wire::vicon {

inline constexpr int kDataStreamPort = 801;
inline constexpr std::uint32_t kPacketMagic = 0x1A2B0001;
inline constexpr std::size_t kPacketHeaderBytes = 8;
/// Larger packets are treated as invalid; 10 000 subjects fit into this size.
inline constexpr std::size_t kPacketBytesMax = std::size_t{2} << 20U;

enum BlockType : std::uint32_t {
  kStreamInfo = 1,
  kSubjectInfo = 2,
  kFrameInfo = 5,
  kLocalSegments = 8,
  kGlobalSegments = 9,
  kTimecode = 23,
  kLatencyInfo = 26,
  kSubjectHealth = 29,
  kHardwareFrameInfo = 36,
  kApplicationInfo = 37,
  kFrameRateInfo = 39,
  kObjectQuality = 40,
  kPing = 42,
  kLightweightSegments = 901,
  kObjectEnums = 100001,
  kRequestFrame = 100002,
  kKeepAlive = 100003,
  kContents = 100004,
  kStartMulticastSender = 100005,
  kStopMulticastSender = 100006,
  kFilter = 100007,
  kRequestNextFrame = 100008,
};

/// True for blocks that describe the scene and are sent only when the scene changes. They form the
/// static set. A packet with a static block replaces the complete set.
bool is_static(std::uint32_t type);
/// True for blocks with data of one frame, not static data; a packet without such a block is not a
/// frame.
bool is_dynamic(std::uint32_t type);

/// Returns the first packet of `stream`. A wrong magic number is detected at its first wrong byte.
Framed next_packet(Bytes stream);

/// One block of a packet.
struct Block {
  std::uint32_t type = 0;
  Bytes body;
};

/// Iterator over the blocks of a packet's body.
class BlockCursor {
 public:
  explicit BlockCursor(Bytes packet_body) : reader_(packet_body) {}
  /// Returns the next block; nullopt at the end, or if the remaining bytes are not a block
  /// (is_broken()).
  std::optional<Block> next();
  [[nodiscard]] bool is_broken() const { return !reader_.ok(); }

 private:
  Reader<std::endian::little> reader_;
};

/// Writer that appends one packet to a buffer. Blocks are added between construction and finish().
class PacketWriter {
 public:
  explicit PacketWriter(std::vector<std::uint8_t>& out);
  void begin_block(std::uint32_t type);
  void end_block();
  /// Writes the packet's length. Call it once, after the last block.
  void finish();

  [[nodiscard]] Writer<std::endian::little>& body() { return writer_; }

 private:
  Writer<std::endian::little> writer_;
  std::size_t packet_start_;
  std::size_t block_start_ = 0;
};

}  // namespace vantage::wire::vicon
