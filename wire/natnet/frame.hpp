#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "wire/natnet/packet.hpp"

namespace vantage::wire::natnet {

/// Pose of one rigid body.
struct RigidBody {
  std::int32_t id = 0;
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector4f rotation_xyzw{0.0F, 0.0F, 0.0F, 1.0F};
  float mean_error_m = 0.0F;
  bool is_tracked = false;  ///< false: the pose is old or not finite
};

/// Bits of Frame::flags.
inline constexpr std::uint16_t kFlagRecording = 1;
inline constexpr std::uint16_t kFlagDefinitionsChanged = 2;
inline constexpr std::uint16_t kFlagEditMode = 4;
inline constexpr std::uint16_t kFlagBitstreamChanged = 8;

/// Frame of all rigid bodies. Markers, skeletons, assets, plates and devices are skipped.
struct Frame {
  std::uint32_t number = 0;
  std::vector<RigidBody> bodies;
  double since_start_s = 0.0;  ///< s; time since the start of the server
  // Ticks of the server's clock (ServerInfo::ticks_per_s).
  std::uint64_t exposed_ticks = 0;   ///< middle of the exposure; 0: the cameras do not report it
  std::uint64_t received_ticks = 0;  ///< arrival of the images at the server
  std::uint64_t sent_ticks = 0;
  std::uint16_t flags = 0;
};

/// Reads the payload of a frame packet in the layout of `version`. Returns false if a section is
/// longer than the packet, or if the sections do not end where the frame's last fields begin.
/// Since version 4.1, unknown sections may precede these last fields.
[[nodiscard]] bool decode_frame(Bytes payload, const Version& version, Frame& out);

/// Appends a frame packet. Returns false if the packet would be too large.
bool append_frame(std::vector<std::uint8_t>& out, const Version& version, const Frame& frame);

}  // namespace vantage::wire::natnet
