#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wire/vicon/bytes.hpp"

// Vicon Tracker's UDP object stream (destination port 51001): little-endian datagrams, from the
// server only.

namespace vantage::wire::vicon {

inline constexpr int kObjectStreamPort = 51001;
inline constexpr std::size_t kObjectHeaderBytes = 5;
inline constexpr std::size_t kObjectNameBytes = 24;
/// bytes; size of name, translation and rotation
inline constexpr std::uint16_t kObjectItemBytes = 72;
inline constexpr std::size_t kObjectsMax = 255;  ///< maximum number of objects in a datagram

/// One tracker object, as encoded in a datagram.
struct TrackerObject {
  std::array<char, kObjectNameBytes> padded_name{};  ///< NUL padded; a full name has no NUL
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d euler_xyz_rad = Eigen::Vector3d::Zero();  ///< rad, intrinsic, world from body

  [[nodiscard]] std::string_view name() const;
  /// Stores the first 24 bytes of `name`.
  void set_name(std::string_view name);
};

/// Content of one datagram.
struct ObjectBlock {
  std::uint32_t frame_number = 0;
  std::vector<TrackerObject> objects;  ///< at most kObjectsMax objects, all with a name
  int skipped_items = 0;               ///< items of another kind, too short, or without a name
  bool is_truncated = false;           ///< the datagram ended within an announced item
};

/// Decodes a datagram into `block`, and reuses the memory of `block`. Returns false without
/// decoding if the datagram is shorter than a header. Items of an unknown kind or size are skipped
/// by their length. Bytes after the last item are padding and ignored. Memory is constant: 255
/// objects.
bool decode_object_block(Bytes datagram, ObjectBlock& block);

/// Returns the number of objects that fit into `block_bytes`: 3, 6, 13 for 256, 512, 1024.
constexpr std::size_t objects_per_block(std::size_t block_bytes) {
  const std::size_t fit =
      block_bytes < kObjectHeaderBytes ? 0 : (block_bytes - kObjectHeaderBytes) / 75;
  return fit < kObjectsMax ? fit : kObjectsMax;
}

/// Encodes `block` into `datagram`, zero padded to `block_bytes` (0: no padding). Precondition: at
/// most objects_per_block(block_bytes) objects; kObjectsMax without padding.
void encode_object_block(const ObjectBlock& block, std::size_t block_bytes,
                         std::vector<std::uint8_t>& datagram);

}  // namespace vantage::wire::vicon
