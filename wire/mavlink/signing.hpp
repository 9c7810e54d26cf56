#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>

#include "core/time.hpp"
#include "wire/mavlink/frame.hpp"

// Message signing. Source: MAVLink developer guide, message signing.

namespace vantage::wire::mavlink {

/// Overwrites a secret with zeros; no compiler optimisation removes the overwriting.
void wipe(std::span<std::uint8_t> secret);

/// Shared secret of a link. Every copy is overwritten with zeros on destruction.
struct SigningKey : std::array<std::uint8_t, 32> {
  constexpr ~SigningKey() {
    if (!std::is_constant_evaluated()) {
      wipe(*this);
    }
  }
};

/// Returns the signing time in units of 10 µs since 2015-01-01, 48 bits; 0 for earlier times.
std::uint64_t signing_timestamp_10us(Time time);

/// Returns the first 48 bits of SHA-256(key ‖ header ‖ payload ‖ CRC ‖ link id ‖ timestamp).
std::array<std::uint8_t, 6> truncated_signature(const SigningKey& key, const Frame& frame,
                                                std::uint8_t link_id, std::uint64_t timestamp_10us);

enum class SignatureVerdict {
  kGood,
  kUnsigned,
  kWrong,          ///< signature of another key, or frame modified in transit
  kReplayed,       ///< timestamp not newer than the last of its stream, or too old for a new stream
  kTooManyStreams  ///< the limit of streams per link is reached
};

/// One end of a signed link: signs outgoing frames and checks incoming frames.
class Signer {
 public:
  Signer(const SigningKey& key, std::uint8_t link_id) : key_(key), link_id_(link_id) {}

  /// Signs `frame`, which must be of version 2. Timestamps increase with each call, even if `now`
  /// is constant or decreases.
  void sign(Frame& frame, Time now);
  /// Checks a frame that arrived at `now`. A stream is identified by (system, component, link id),
  /// and its timestamps must increase. The first timestamp of a new stream may be at most one
  /// minute behind the newest timestamp of this end.
  SignatureVerdict check(const Frame& frame, Time now);

 private:
  using Stream = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;
  static constexpr std::size_t kStreamsMax = 64;

  SigningKey key_;
  std::uint8_t link_id_;
  /// newest timestamp sent by this end or accepted from the other end
  std::uint64_t newest_10us_ = 0;
  std::map<Stream, std::uint64_t> streams_;
};

}  // namespace vantage::wire::mavlink
