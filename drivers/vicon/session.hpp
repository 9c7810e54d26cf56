#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/vicon/seen_frame.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::drivers::vicon {

using FrameSink = std::function<void(const SeenFrame&)>;

/// Counters of a session, since the construction of the driver.
struct WireCounts {
  std::int64_t broken_streams = 0;  ///< bytes that do not belong to the protocol
  std::int64_t broken_blocks = 0;   ///< parts of a frame that could not be read
  /// frames received before the server sends the requested content
  std::int64_t frames_before_set = 0;
  std::int64_t unnamed_bodies = 0;    ///< poses of subjects without a description
  std::int64_t late_blocks = 0;       ///< parts that arrived after their frame was assumed complete
  std::int64_t duplicate_blocks = 0;  ///< repeated parts of a frame
};

/// Rate at which a server reports one body.
struct BodyRate {
  std::string name;
  double rate_hz = 0.0;  ///< Hz; 0: too few reports
};

/// Multicast address and UDP port at which a server sends its frames.
struct MulticastGroup {
  std::array<std::uint8_t, 4> address{};
  std::uint16_t port = 0;
  friend bool operator==(const MulticastGroup&, const MulticastGroup&) = default;
};

/// Client of one protocol, as a pure state machine. Bytes and time are passed in. Frames are passed
/// to the sink within the call; bytes to send are stored in `outgoing`.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  Session(Session&&) = delete;
  Session& operator=(Session&&) = delete;

  /// Starts a new connection and clears the state of the previous one.
  virtual void open(Moment now) = 0;
  /// Processes the next bytes of the stream, split at any position, or one datagram. Returns false
  /// if the bytes do not belong to this protocol and the connection is unusable.
  [[nodiscard]] virtual bool receive(Moment arrival, wire::vicon::Bytes bytes) = 0;
  /// Performs the work that is due.
  virtual void on_time(Moment now) = 0;
  /// Returns the steady time at which on_time() has work to do.
  [[nodiscard]] virtual Duration next_wake() const = 0;

  /// Returns the rate of each body if the protocol reports bodies at separate instants; otherwise
  /// empty.
  [[nodiscard]] virtual std::vector<BodyRate> rates() const { return {}; }

  /// Returns the group from which frames must be received in addition to the connection; nullopt if
  /// there is none.
  [[nodiscard]] virtual std::optional<MulticastGroup> group() const { return std::nullopt; }

  /// Bytes for the server; the sender erases what it has sent. One datagram if the protocol uses
  /// datagrams.
  std::vector<std::uint8_t> outgoing;
  /// Reason why the connection is unusable; empty: receive() gives the reason by its result.
  std::string refusal;
  WireCounts counts;
};

}  // namespace vantage::drivers::vicon
