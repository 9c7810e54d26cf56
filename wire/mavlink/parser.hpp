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

/// What a Parser has seen.
struct ParserCounts {
  std::int64_t frames = 0;         ///< handed on
  std::int64_t frames_v1 = 0;      ///< of these, in version 1
  std::int64_t unknown = 0;        ///< whole frames of messages that are not in AllMessages
  std::int64_t unknown_flags = 0;  ///< frames dropped for an incompatible flag nobody knows
  std::int64_t bytes_skipped = 0;  ///< that belong to no frame: noise, wrong CRC, cut off
};

/// Finds frames in a stream of bytes that comes in pieces of any size, with noise between and in
/// them. Bounded: it keeps at most kBufferBytes whatever arrives. After a wrong byte it looks for
/// the next frame from the byte after the false start, so no good frame is lost to a bad one.
class Parser {
 public:
  /// Calls handle(const Frame&) with each frame that ends within `bytes`.
  template <class Handle>
  void feed(std::span<const std::uint8_t> bytes, const Handle& handle) {
    while (!bytes.empty()) {
      bytes = bytes.subspan(fill(bytes));
      while (const std::optional<Frame> frame = next()) {
        handle(*frame);
      }
    }
  }
  /// Gives up what is incomplete, because nothing that belongs to it will come (the end of a
  /// datagram, a pause on a serial line); good frames within it are still found.
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

  /// Takes what there is room for; how much.
  std::size_t fill(std::span<const std::uint8_t> bytes);
  /// The next frame that is complete in the buffer.
  std::optional<Frame> next();
  /// What stands at the marker at begin_, or nullopt and true in `is_incomplete`.
  std::optional<Frame> read_frame(bool& is_incomplete);
  void skip(std::size_t bytes);

  std::array<std::uint8_t, kBufferBytes> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  ParserCounts counts_;
};

/// Counts what was lost on the way from each sender, by its running numbers (8 bits, so a loss of
/// 128 frames or more in one go looks like reordering). Keeps at most kSendersMax senders.
class SequenceMonitor {
 public:
  void see(const Origin& origin);
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t out_of_order() const { return out_of_order_; }

 private:
  static constexpr std::size_t kSendersMax = 64;
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::uint8_t> expected_;
  std::int64_t lost_ = 0;
  std::int64_t out_of_order_ = 0;
};

}  // namespace vantage::wire::mavlink
