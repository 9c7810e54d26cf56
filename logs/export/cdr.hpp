#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace vantage::logs {

/// Builder of a ROS 2 message in plain CDR: little-endian, each number aligned to its own size.
/// Source: OMG, Extended CDR encoding 1 (DDS-XTypes 1.3, 7.4.1).
class Cdr {
 public:
  template <class Number>
  Cdr& number(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.resize(kHeader +
                  (bytes_.size() - kHeader + sizeof value - 1) / sizeof value * sizeof value);
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);  // all target machines are little-endian
    bytes_.append(raw, sizeof value);
    return *this;
  }
  /// Appends the length of a sequence; its elements must follow.
  Cdr& count(std::size_t elements) { return number(static_cast<std::uint32_t>(elements)); }
  Cdr& text(std::string_view text) {
    count(text.size() + 1);
    bytes_.append(text).push_back('\0');
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kHeader = 4;
  std::string bytes_ =
      std::string("\0\1\0\0", kHeader);  ///< encapsulation header: CDR_LE, no options
};

}  // namespace vantage::logs
