#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

// Conversion between numbers and bytes in little-endian or big-endian order.

namespace vantage::wire::vicon {

using Bytes = std::span<const std::uint8_t>;

/// Reader of consecutive numbers. Reading beyond the end returns zeros and makes ok() false
/// permanently; no memory outside `bytes` is read.
template <std::endian kOrder>
class Reader {
 public:
  explicit Reader(Bytes bytes) : rest_(bytes) {}

  std::uint8_t u8() { return unsigned_integer<std::uint8_t>(); }
  std::uint16_t u16() { return unsigned_integer<std::uint16_t>(); }
  std::uint32_t u32() { return unsigned_integer<std::uint32_t>(); }
  std::uint64_t u64() { return unsigned_integer<std::uint64_t>(); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  std::int64_t i64() { return static_cast<std::int64_t>(u64()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }

  /// Returns the next `count` bytes. If fewer remain, returns no bytes and makes ok() false.
  Bytes take(std::size_t count) {
    if (count > rest_.size()) {
      is_ok_ = false;
      rest_ = {};
      return {};
    }
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::string_view text(std::size_t count) {
    const Bytes taken = take(count);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }
  /// Returns the text before the next NUL and skips both. Without a NUL, returns "" and makes ok()
  /// false.
  std::string_view terminated_text() {
    const auto end = std::find(rest_.begin(), rest_.end(), std::uint8_t{0});
    if (end == rest_.end()) {
      is_ok_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view out = text(static_cast<std::size_t>(end - rest_.begin()));
    take(1);
    return out;
  }
  /// Reads the number of the following elements, each of at least `element_bytes`. If the remaining
  /// bytes are too few for this number, returns 0 and makes ok() false.
  std::uint32_t count(std::size_t element_bytes) {
    const std::uint32_t elements = u32();
    if (elements > rest_.size() / element_bytes) {
      is_ok_ = false;
      rest_ = {};
      return 0;
    }
    return elements;
  }

  [[nodiscard]] bool ok() const { return is_ok_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  template <class Unsigned>
  Unsigned unsigned_integer() {
    const Bytes taken = take(sizeof(Unsigned));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const std::size_t from_low = kOrder == std::endian::little ? i : sizeof(Unsigned) - 1 - i;
      value |= std::uint64_t{taken[i]} << (8U * from_low);
    }
    return static_cast<Unsigned>(value);
  }

  Bytes rest_;
  bool is_ok_ = true;
};

/// Writer that appends numbers to a buffer. It does not allocate memory if a cleared buffer is
/// reused.
template <std::endian kOrder>
class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_(out) {}

  void u8(std::uint8_t value) { out_.push_back(value); }
  void u16(std::uint16_t value) { append(value); }
  void u32(std::uint32_t value) { append(value); }
  void u64(std::uint64_t value) { append(value); }
  void i32(std::int32_t value) { append(static_cast<std::uint32_t>(value)); }
  void i64(std::int64_t value) { append(static_cast<std::uint64_t>(value)); }
  void f32(float value) { append(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { append(std::bit_cast<std::uint64_t>(value)); }
  void text(std::string_view text) { out_.insert(out_.end(), text.begin(), text.end()); }
  void zeros(std::size_t count) { out_.insert(out_.end(), count, 0); }

  /// Overwrites the four bytes at `offset`, for lengths that are known only after the content.
  void patch_u32(std::size_t offset, std::uint32_t value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      const std::size_t from_low = kOrder == std::endian::little ? i : sizeof value - 1 - i;
      out_[offset + i] = static_cast<std::uint8_t>(value >> (8U * from_low));
    }
  }
  [[nodiscard]] std::size_t size() const { return out_.size(); }

 private:
  template <class Unsigned>
  void append(Unsigned value) {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      const std::size_t from_low = kOrder == std::endian::little ? i : sizeof value - 1 - i;
      out_.push_back(static_cast<std::uint8_t>(value >> (8U * from_low)));
    }
  }

  std::vector<std::uint8_t>& out_;
};

}  // namespace vantage::wire::vicon
