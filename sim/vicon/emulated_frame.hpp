#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "scenario/mocap_spec.hpp"

namespace vantage::sim::vicon {

struct EmulatedBody {
  std::string name;
  Pose3 world_from_body;  ///< z up
  bool is_occluded = false;
};

/// What the cameras saw at one instant.
struct EmulatedFrame {
  std::uint32_t number = 0;
  Time captured{};         ///< on the server's clock
  double latency_s = 0.0;  ///< until the server had it
  std::vector<EmulatedBody> bodies;
};

/// How an occluded body looks on the wire. A DataStream leaves it out, whatever this says.
enum class OcclusionStyle {
  kAbsent,
  kZero,      ///< all numbers zero
  kRepeated,  ///< its last pose, for ever
};

struct ServerSettings {
  scenario::MocapProtocol protocol = scenario::MocapProtocol::kDataStream;
  double rate_hz = 100.0;
  std::size_t block_bytes = 256;  ///< of an object stream's datagram: 256, 512 or 1024
  bool is_y_up = false;           ///< the world that is sent, as Nexus and Blade have it
  OcclusionStyle occlusion = OcclusionStyle::kAbsent;
  /// Bytes that may wait for a client that does not read; beyond it frames are skipped.
  std::size_t backlog_bytes_max = std::size_t{4} << 20U;
};

}  // namespace vantage::sim::vicon
