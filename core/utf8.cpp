#include "core/utf8.hpp"

#include <cstddef>

namespace vantage {
namespace {

unsigned char byte_at(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

}  // namespace

std::size_t utf8_bytes(std::string_view text, std::size_t at) {
  const unsigned char first = byte_at(text, at);
  if (first < 0x80U) {
    return first == 0 ? 0 : 1;
  }
  const std::size_t length = first >= 0xC2U && first < 0xE0U   ? 2
                             : first >= 0xE0U && first < 0xF0U ? 3
                             : first >= 0xF0U && first < 0xF5U ? 4
                                                               : 0;
  if (length == 0 || at + length > text.size()) {
    return 0;
  }
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte_at(text, at + k) & 0xC0U) != 0x80U) {
      return 0;
    }
  }
  const unsigned char second = byte_at(text, at + 1);
  const bool is_overlong = (first == 0xE0U && second < 0xA0U) || (first == 0xF0U && second < 0x90U);
  const bool is_no_character =
      (first == 0xEDU && second >= 0xA0U) || (first == 0xF4U && second >= 0x90U);
  return is_overlong || is_no_character ? 0 : length;
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_bytes(text, at);
    if (length == 0) {
      return false;
    }
    at += length;
  }
  return true;
}

std::string readable(std::string_view text) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_bytes(text, at);
    const unsigned char first = byte_at(text, at);
    if (length == 0 || first < 0x20U || first == 0x7FU || first == '\\') {
      out += {'\\', 'x', kDigits[first >> 4U], kDigits[first & 0x0FU]};
      ++at;
      continue;
    }
    out += text.substr(at, length);
    at += length;
  }
  return out;
}

}  // namespace vantage
