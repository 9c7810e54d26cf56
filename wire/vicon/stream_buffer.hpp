#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "wire/vicon/bytes.hpp"

namespace vantage::wire::vicon {

/// What of a byte stream has arrived and is not yet understood, in a buffer that never grows.
class StreamBuffer {
 public:
  explicit StreamBuffer(std::size_t capacity) : buffer_(capacity) {}

  /// Takes as many of `bytes` as there is room for; how many. 0 of a non-empty span means that
  /// view() is full.
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
  /// Drops the first `count` ≤ view().size() bytes of view().
  void consume(std::size_t count) {
    begin_ += count;
    if (begin_ == end_) {
      clear();
    }
  }
  void clear() { begin_ = end_ = 0; }
  [[nodiscard]] std::size_t capacity() const { return buffer_.size(); }

 private:
  static std::ptrdiff_t offset(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

/// What the beginning of a byte stream holds.
enum class Framing {
  kWhole,     ///< a whole packet or message
  kNeedMore,  ///< the beginning of one
  kBroken,    ///< nothing of this protocol, or longer than allowed: the stream is lost
};

/// The first packet or message of a stream.
struct Framed {
  Framing state = Framing::kNeedMore;
  Bytes body;             ///< of a whole one
  std::size_t bytes = 0;  ///< to consume, header and padding included
};

}  // namespace vantage::wire::vicon
