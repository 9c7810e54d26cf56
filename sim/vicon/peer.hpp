#pragma once

#include <cstdint>
#include <vector>

#include "sim/vicon/emulated_frame.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::sim::vicon {

/// The server's side of one client's connection, as a pure state machine: bytes and frames in,
/// bytes out.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  Peer(Peer&&) = delete;
  Peer& operator=(Peer&&) = delete;

  /// The client's bytes, cut anywhere. False: it does not speak this protocol; hang up.
  [[nodiscard]] virtual bool receive(wire::vicon::Bytes bytes) = 0;
  /// The newest frame; sent now, later or never, as the client has asked.
  virtual void on_frame(const EmulatedFrame& frame) = 0;

  std::vector<std::uint8_t> outgoing;  ///< whoever sends them erases what he sent
  std::int64_t frames_sent = 0;
  std::int64_t frames_skipped = 0;  ///< the client did not read
};

}  // namespace vantage::sim::vicon
