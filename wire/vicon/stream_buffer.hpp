#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "wire/vicon/bytes.hpp"

namespace vantage::wire::vicon {

/// State of the first packet or message in a byte stream.
enum class Framing {
  kWhole,     ///< the packet is complete
  kNeedMore,  ///< the packet is incomplete
  kBroken,    ///< not this protocol, or too long: the stream is unusable
};

/// First packet or message of a stream.
struct Framed {
  Framing state = Framing::kNeedMore;
  Bytes body;             ///< content of a complete packet or message
  std::size_t bytes = 0;  ///< number of bytes to consume, including header and padding
};

/// Buffer of fixed size for the bytes of a stream that have arrived but are not yet decoded.
class StreamBuffer {
 public:
  explicit StreamBuffer(std::size_t capacity) : buffer_(capacity) {}

  /// Appends the first bytes of `bytes` that fit, and returns their number. The result is 0 for a
  /// non-empty span if view() is full.
  std::size_t push(Bytes bytes) {
    if (bytes.size() > buffer_.size() - end_ && begin_ > 0) {
      std::copy(buffer_.begin() + offset(begin_), buffer_.begin() + offset(end_), buffer_.begin());
      end_ -= begin_;
      begin_ = 0;
    }
    const std::size_t taken = std::min(bytes.size(), buffer_.size() - end_);
    std::copy_n(bytes.begin(), taken, buffer_.begin() + offset(end_));
    end_ += taken;
    return taken;
  }
  [[nodiscard]] Bytes view() const { return Bytes(buffer_).subspan(begin_, end_ - begin_); }
  /// Removes the first `count` bytes of view(). Precondition: count ≤ view().size().
  void consume(std::size_t count) {
    begin_ += count;
    if (begin_ == end_) {
      clear();
    }
  }
  void clear() { begin_ = end_ = 0; }

  /// Appends `bytes` and passes each complete packet to `handle`.
  ///
  /// @param next    returns the first packet of a view: a value with `state` and `bytes`
  /// @param handle  returns false to refuse the packet
  /// @returns false if a packet was refused, is broken or exceeds the capacity.
  template <class Next, class Handle>
  [[nodiscard]] bool receive(Bytes bytes, const Next& next, const Handle& handle) {
    while (!bytes.empty()) {
      const std::size_t taken = push(bytes);
      if (taken == 0) {
        return false;
      }
      bytes = bytes.subspan(taken);
      for (auto packet = next(view()); packet.state != Framing::kNeedMore; packet = next(view())) {
        if (packet.state == Framing::kBroken || !handle(packet)) {
          return false;
        }
        consume(packet.bytes);
      }
    }
    return true;
  }

 private:
  static std::ptrdiff_t offset(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace vantage::wire::vicon
