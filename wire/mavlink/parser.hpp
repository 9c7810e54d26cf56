#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "wire/mavlink/frame.hpp"

namespace vantage::wire::mavlink {

/// Counters of a Parser since its start.
struct ParserCounts {
  std::int64_t frames = 0;         ///< delivered frames
  std::int64_t frames_v1 = 0;      ///< delivered frames of version 1
  std::int64_t unknown = 0;        ///< complete frames of messages that are not in AllMessages
  std::int64_t unknown_flags = 0;  ///< frames dropped because of an unknown incompatible flag
  std::int64_t bytes_skipped = 0;  ///< bytes outside frames: noise, wrong CRC, truncated
};

/// Parser that finds frames in a byte stream, which arrives in pieces of any size and may contain
/// noise between and within frames. It stores at most kBufferBytes. After an invalid frame, it
/// continues the search one byte after the start of that frame, so an invalid frame cannot hide a
/// valid one.
class Parser {
 public:
  /// Calls handle(const Frame&) for each frame that ends within `bytes`.
  template <class Handle>
  void feed(std::span<const std::uint8_t> bytes, const Handle& handle) {
    while (!bytes.empty()) {
      bytes = bytes.subspan(fill(bytes));
      while (const std::optional<Frame> frame = next()) {
        handle(*frame);
      }
    }
  }
  /// Discards an incomplete frame, but delivers valid frames within its bytes. Call this function
  /// when the missing bytes cannot arrive: after a datagram, or after a pause on a serial line.
  template <class Handle>
  void flush(const Handle& handle) {
    while (begin_ != end_) {
      skip(1);
      while (const std::optional<Frame> frame = next()) {
        handle(*frame);
      }
    }
  }

  [[nodiscard]] const ParserCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kBufferBytes = 1024;

  /// Copies the bytes that fit into the buffer, and returns their number.
  std::size_t fill(std::span<const std::uint8_t> bytes);
  /// Returns the next frame that is complete in the buffer.
  std::optional<Frame> next();
  /// Reads the frame that has its marker at begin_. Sets `is_incomplete` when bytes are missing.
  std::optional<Frame> read_frame(bool& is_incomplete);
  void skip(std::size_t bytes);

  std::array<std::uint8_t, kBufferBytes> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  ParserCounts counts_;
};

/// Counter of lost frames per sender, by sequence numbers. The numbers have 8 bits, so a loss of
/// 128 or more consecutive frames is mistaken for reordering. Stores at most kSendersMax senders.
class SequenceMonitor {
 public:
  void on_frame(const Origin& origin);
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t out_of_order() const { return out_of_order_; }

 private:
  static constexpr std::size_t kSendersMax = 64;
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> expected_;
  std::int64_t lost_ = 0;
  std::int64_t out_of_order_ = 0;
};

}  // namespace vantage::wire::mavlink
