#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/vicon/emulated_frame.hpp"
#include "wire/vicon/object_stream.hpp"

namespace vantage::sim::vicon {

/// Encoder of Tracker's UDP object stream: a frame is split into datagrams of a fixed size, all
/// with the frame's number.
class ObjectStreamServer {
 public:
  explicit ObjectStreamServer(const ServerSettings& settings) : settings_(settings) {}

  /// Returns the datagrams of `frame`; at least one, even without a visible body. Names are cut to
  /// 24 bytes.
  const std::vector<std::vector<std::uint8_t>>& encode(const EmulatedFrame& frame);

 private:
  ServerSettings settings_;
  /// last visible pose per body, for kRepeated
  std::map<std::string, wire::vicon::TrackerObject> last_seen_;
  std::vector<std::vector<std::uint8_t>> datagrams_;
};

}  // namespace vantage::sim::vicon
