#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wire/vicon/bytes.hpp"

// Vicon Tracker's UDP object stream (destination port 51001): little-endian datagrams, one way.

namespace vantage::wire::vicon {

inline constexpr int kObjectStreamPort = 51001;
inline constexpr std::size_t kObjectHeaderBytes = 5;
inline constexpr std::size_t kObjectNameBytes = 24;
inline constexpr std::uint16_t kObjectItemBytes = 72;  ///< name, translation, rotation
inline constexpr std::size_t kObjectsMax = 255;        ///< what the count of a datagram can say

/// One tracker object as it is on the wire.
struct TrackerObject {
  std::array<char, kObjectNameBytes> padded_name{};  ///< NUL padded, may fill all
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d euler_xyz_rad = Eigen::Vector3d::Zero();  ///< intrinsic, world from body

  [[nodiscard]] std::string_view name() const;
  /// Keeps the first 24 bytes of `name`.
  void set_name(std::string_view name);
};

/// One datagram.
struct ObjectBlock {
  std::uint32_t frame_number = 0;
  std::vector<TrackerObject> objects;  ///< at most kObjectsMax; those with a name
  int skipped_items = 0;               ///< of another kind, too short, or nameless
  bool is_truncated = false;           ///< it ended within an item that the count promised
};

/// Decodes a datagram into `block`, whose memory is reused. False, and nothing decoded, for one
/// that is shorter than a header. Items of a kind or size that this stream does not have are
/// skipped by their length. Bytes after the last item are padding and are not looked at.
/// Constant memory: 255 objects.
bool decode_object_block(Bytes datagram, ObjectBlock& block);

/// How many objects fit into a datagram of `block_bytes`: 3, 6, 13 for 256, 512, 1024.
constexpr std::size_t objects_per_block(std::size_t block_bytes) {
  const std::size_t fit =
      block_bytes < kObjectHeaderBytes ? 0 : (block_bytes - kObjectHeaderBytes) / 75;
  return fit < kObjectsMax ? fit : kObjectsMax;
}

/// Replaces `datagram` by the encoding of `block`, zero padded to `block_bytes` (0: no padding).
/// Precondition: no more objects than objects_per_block(block_bytes), kObjectsMax without padding.
void encode_object_block(const ObjectBlock& block, std::size_t block_bytes,
                         std::vector<std::uint8_t>& datagram);

}  // namespace vantage::wire::vicon
