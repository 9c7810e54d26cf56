#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drivers/vicon/seen_frame.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::drivers::vicon {

using FrameSink = std::function<void(const SeenFrame&)>;

/// What a session counts, by what went wrong; all since the driver was made.
struct WireCounts {
  std::int64_t broken_streams = 0;     ///< bytes that are not of the protocol
  std::int64_t broken_blocks = 0;      ///< parts of a frame that could not be read
  std::int64_t frames_before_set = 0;  ///< of a stream that has just been asked for its content
  std::int64_t unnamed_bodies = 0;     ///< poses of subjects that nobody has introduced
  std::int64_t late_blocks = 0;        ///< parts of a frame that was thought whole
  std::int64_t duplicate_blocks = 0;   ///< parts of a frame that had come before
};

/// How often a server reports a body by itself.
struct BodyRate {
  std::string name;
  double rate_hz = 0.0;  ///< 0: too few reports to tell
};

/// One protocol's side of a conversation, as a pure state machine: bytes and time in, frames (to
/// the sink, within the call) and bytes out.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  Session(Session&&) = delete;
  Session& operator=(Session&&) = delete;

  /// A new connection: everything said on the one before is forgotten.
  virtual void open(Moment now) = 0;
  /// The next bytes of the stream, cut anywhere, or one datagram. False: this is not the protocol,
  /// and nothing more can be made of this connection.
  [[nodiscard]] virtual bool receive(Moment arrival, wire::vicon::Bytes bytes) = 0;
  /// Time has passed.
  virtual void on_time(Moment now) = 0;
  /// The steady time at which on_time() has something to do.
  [[nodiscard]] virtual Duration next_wake() const = 0;

  /// Of each body, in a protocol whose bodies report each at instants of their own; else empty.
  [[nodiscard]] virtual std::vector<BodyRate> rates() const { return {}; }

  /// Bytes for the server; whoever sends them clears what he sent.
  std::vector<std::uint8_t> outgoing;
  WireCounts counts;
};

}  // namespace vantage::drivers::vicon
