#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/vicon/peer.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::sim::vicon {

/// Server side of one client's connection to the emulated VRPN server: each body is a sender of
/// poses of sensor 0. Both sides start with their cookie; the server sends names after the client's
/// cookie and answers pings.
class VrpnPeer : public Peer {
 public:
  explicit VrpnPeer(const ServerSettings& settings);

  [[nodiscard]] bool receive(wire::vicon::Bytes bytes) override;
  void on_frame(const EmulatedFrame& frame) override;

 private:
  static constexpr std::size_t kNamesMax = 1024;

  std::int32_t sender_of(const std::string& name);
  void on_message(const wire::vicon::VrpnHeader& header, wire::vicon::Bytes payload);

  ServerSettings settings_;
  wire::vicon::StreamBuffer stream_;
  bool is_greeted_ = false;                      ///< the client's cookie was received
  std::map<std::string, std::int32_t> senders_;  ///< sender numbers of the server
  std::map<std::int32_t, std::string> client_senders_;
  std::map<std::int32_t, std::string> client_types_;
  /// last visible pose per body, for kRepeated
  std::map<std::string, wire::vicon::VrpnPose> last_seen_;
};

}  // namespace vantage::sim::vicon
