#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "scenario/mocap_spec.hpp"

namespace vantage::sim::vicon {

struct EmulatedBody {
  std::string name;
  Pose3 world_from_body;  ///< true pose in a world with z up
  bool is_occluded = false;
};

/// Bodies captured at one instant.
struct EmulatedFrame {
  std::uint32_t number = 0;
  Time captured{};         ///< time of capture by the server's clock
  double latency_s = 0.0;  ///< s; time from capture to sending by the server
  std::vector<EmulatedBody> bodies;
};

/// Representation of an occluded body in the protocol. A DataStream always omits occluded bodies;
/// NatNet and QTM mark them.
enum class OcclusionStyle {
  kAbsent,
  kZero,      ///< position and orientation all zero
  kRepeated,  ///< the body's last pose, repeated
};

struct ServerSettings {
  scenario::MocapProtocol protocol = scenario::MocapProtocol::kDataStream;
  double rate_hz = 100.0;
  std::size_t block_bytes = 256;  ///< datagram size of an object stream: 256, 512 or 1024
  bool is_y_up = false;           ///< sends poses with y up, as Nexus and Blade do
  OcclusionStyle occlusion = OcclusionStyle::kAbsent;
  std::array<std::uint8_t, 2> natnet_version{4, 1};  ///< major and minor; 3.0 or later
  /// NatNet: sends frames to the default multicast group instead of to each client.
  bool is_multicast = false;
  /// NatNet: source port of frames and destination port of the multicast group. 0: frames are sent
  /// from the port that answers requests, and the group has port 1511.
  std::uint16_t data_port = 0;
  /// Maximum number of unsent bytes for a client that does not read. Frames beyond it are skipped.
  std::size_t backlog_bytes_max = std::size_t{4} << 20U;
};

}  // namespace vantage::sim::vicon
