#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/vicon/peer.hpp"
#include "wire/natnet/definitions.hpp"
#include "wire/natnet/frame.hpp"

namespace vantage::sim::vicon {

/// Server side of one NatNet client, or of the multicast group, with the configured version.
///
/// It answers connection requests, requests for definitions and echo requests. Frames are sent only
/// after a connection request. An occluded body keeps its last pose, without the tracking bit.
/// For one second after a body appears or disappears, frames have the flag "definitions changed".
class NatNetPeer : public Peer {
 public:
  static constexpr std::uint64_t kTicksPerSecond = 10'000'000;

  /// @param is_group  peer of the multicast group: sends frames without a request
  explicit NatNetPeer(const ServerSettings& settings, bool is_group = false);

  /// Processes one datagram. Returns false if it is not a packet; the datagram is then ignored.
  [[nodiscard]] bool receive(wire::vicon::Bytes datagram) override;
  void on_frame(const EmulatedFrame& frame) override;

  [[nodiscard]] bool is_connected() const { return is_connected_; }

 private:
  void define(const EmulatedFrame& frame);

  ServerSettings settings_;
  wire::natnet::Version version_;
  bool is_connected_;
  std::vector<wire::natnet::BodyDefinition> definitions_;
  std::map<std::string, wire::natnet::RigidBody> last_;  ///< last visible pose per body
  Duration changed_until_{};
  wire::natnet::Frame frame_;
};

}  // namespace vantage::sim::vicon
