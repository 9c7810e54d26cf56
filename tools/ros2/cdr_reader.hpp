#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace vantage::tools::ros2 {

/// Reader of a ROS 2 message in plain CDR of either byte order. It reads nothing outside the bytes:
/// after the first error it returns zeros and empty texts, and ok() is false.
/// Source: OMG, Extended CDR encoding 1 (DDS-XTypes 1.3, 7.4.1).
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    constexpr std::uint8_t kLittleEndian = 1;
    is_ok_ = bytes.size() >= kHeader && bytes[0] == 0 && bytes[1] <= kLittleEndian;
    is_swapped_ = is_ok_ && bytes[1] != kLittleEndian;
  }

  [[nodiscard]] bool ok() const { return is_ok_; }

  template <class Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    constexpr std::size_t kSize = sizeof(Number);
    const std::size_t begin = kHeader + (at_ - kHeader + kSize - 1) / kSize * kSize;
    if (!has(begin, kSize)) {
      return {};
    }
    std::array<std::uint8_t, kSize> raw{};
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin), kSize, raw.begin());
    if (is_swapped_) {
      std::reverse(raw.begin(), raw.end());
    }
    Number value{};
    std::memcpy(&value, raw.data(), kSize);  // all target machines are little-endian
    at_ = begin + kSize;
    return value;
  }

  /// Reads the length of a sequence whose elements occupy at least `element_bytes_min` bytes each.
  /// A length for which the message is too short is an error.
  std::size_t count(std::size_t element_bytes_min) {
    const std::size_t count = number<std::uint32_t>();
    return is_ok_ && has(at_, count * element_bytes_min) ? count : 0;
  }

  std::string_view text() {
    const std::size_t size = number<std::uint32_t>();  // includes the final NUL
    if (size == 0 || !has(at_, size)) {
      return {};  // some writers send an empty text without its NUL
    }
    const char* const begin = reinterpret_cast<const char*>(bytes_.data() + at_);  // NOLINT
    at_ += size;
    is_ok_ = begin[size - 1] == '\0';
    return is_ok_ ? std::string_view(begin, size - 1) : std::string_view();
  }

 private:
  static constexpr std::size_t kHeader = 4;

  bool has(std::size_t begin, std::size_t size) {
    is_ok_ = is_ok_ && begin <= bytes_.size() && size <= bytes_.size() - begin;
    return is_ok_;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = kHeader;
  bool is_ok_ = false;
  bool is_swapped_ = false;
};

}  // namespace vantage::tools::ros2
