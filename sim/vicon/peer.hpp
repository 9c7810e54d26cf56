#pragma once

#include <cstdint>
#include <vector>

#include "core/time.hpp"
#include "sim/vicon/emulated_frame.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::sim::vicon {

/// Server side of one client's connection, as a pure state machine: received bytes and frames are
/// passed in, bytes to send are stored in `outgoing`. If the protocol uses datagrams, each call
/// processes one datagram and stores at most one.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  Peer(Peer&&) = delete;
  Peer& operator=(Peer&&) = delete;

  /// Processes bytes of the client, split at any point. Returns false if they break the protocol;
  /// the connection must then be closed.
  [[nodiscard]] virtual bool receive(wire::vicon::Bytes bytes) = 0;
  /// Processes the newest frame; queues it if the client has requested a frame.
  virtual void on_frame(const EmulatedFrame& frame) = 0;

  Duration now{};  ///< server's steady clock; the owner sets it before each call
  std::vector<std::uint8_t> outgoing;  ///< the sender erases the bytes that it has sent
  std::int64_t frames_sent = 0;
  std::int64_t frames_skipped = 0;  ///< frames skipped because the client did not read
};

}  // namespace vantage::sim::vicon
