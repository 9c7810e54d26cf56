#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/vicon/peer.hpp"
#include "wire/qualisys/packet.hpp"

namespace vantage::sim::vicon {

/// Server side of one client's connection to the emulated QTM: greeting, version, names and frames.
/// An occluded body is sent with NaN values. The server's time begins at the first frame. An event
/// announces that a body appeared or disappeared.
class QtmPeer : public Peer {
 public:
  explicit QtmPeer(const ServerSettings& settings);

  [[nodiscard]] bool receive(wire::vicon::Bytes bytes) override;
  void on_frame(const EmulatedFrame& frame) override;

 private:
  void on_command(std::string_view command);
  void stream(std::string_view components);

  ServerSettings settings_;
  wire::vicon::StreamBuffer stream_;
  std::vector<std::string> names_;
  std::optional<Time> start_;
  bool is_streaming_ = false;
  wire::qualisys::Frame frame_;
};

}  // namespace vantage::sim::vicon
