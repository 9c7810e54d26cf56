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

/// Overwrites a secret with zeros, which no compiler leaves out.
void wipe(std::span<std::uint8_t> secret);

/// The shared secret of a link. Every copy is wiped at its end.
struct SigningKey : std::array<std::uint8_t, 32> {
  constexpr ~SigningKey() {
    if (!std::is_constant_evaluated()) {
      wipe(*this);
    }
  }
};

/// Signing time: units of 10 µs since 2015-01-01, 48 bits; 0 before.
std::uint64_t signing_timestamp_10us(Time time);

/// The first 48 bits of SHA-256(key ‖ header ‖ payload ‖ CRC ‖ link id ‖ timestamp).
std::array<std::uint8_t, 6> truncated_signature(const SigningKey& key, const Frame& frame,
                                                std::uint8_t link_id, std::uint64_t timestamp_10us);

enum class SignatureVerdict {
  kGood,
  kUnsigned,
  kWrong,          ///< not made with this key, or changed on the way
  kReplayed,       ///< not newer than the newest of its stream, or of a new stream and too old
  kTooManyStreams  ///< more than a link has senders
};

/// One end of a signed link: signs what goes out, judges what comes in.
class Signer {
 public:
  Signer(const SigningKey& key, std::uint8_t link_id) : key_(key), link_id_(link_id) {}

  /// Signs `frame`, which must be of version 2. Timestamps grow with each call even when `now`
  /// stands still or steps back.
  void sign(Frame& frame, Time now);
  /// Judges a frame that arrived at `now`. A stream is a (system, component, link id); its
  /// timestamps must grow; that of a new stream may be at most a minute behind this end's.
  SignatureVerdict check(const Frame& frame, Time now);

 private:
  using Stream = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;
  static constexpr std::size_t kStreamsMax = 64;

  SigningKey key_;
  std::uint8_t link_id_;
  std::uint64_t newest_10us_ = 0;  ///< sent by this end or accepted from another
  std::map<Stream, std::uint64_t> streams_;
};

}  // namespace vantage::wire::mavlink
