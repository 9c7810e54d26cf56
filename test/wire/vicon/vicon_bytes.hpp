#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::test {

/// Converts hexadecimal digits to bytes; ignores the spaces and bars between them.
inline std::vector<std::uint8_t> from_hex(std::string_view text) {
  const auto value = [](char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; };
  std::string digits;
  for (const char c : text) {
    if (c != ' ' && c != '|' && c != '\n') {
      digits.push_back(c);
    }
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(value(digits[i]) * 16 + value(digits[i + 1])));
  }
  return bytes;
}

inline std::vector<std::uint8_t> from_text(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace vantage::test
