#include "core/utf8.hpp"

#include <cstddef>

namespace vantage {
namespace {

unsigned char byte_at(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

/// True if the character at `at`, which has `length` ≥ 1 bytes, moves the cursor or changes how
/// other characters are displayed: DEL, C1 (U+0080 to U+009F), U+2028 to U+202E, U+2066 to U+2069.
bool is_hidden_control(std::string_view text, std::size_t at, std::size_t length) {
  const unsigned char first = byte_at(text, at);
  if (length == 2) {
    return first == 0xC2U && byte_at(text, at + 1) < 0xA0U;
  }
  if (length == 3 && first == 0xE2U) {
    const unsigned char second = byte_at(text, at + 1);
    const unsigned char third = byte_at(text, at + 2);
    return (second == 0x80U && third >= 0xA8U && third <= 0xAEU) ||
           (second == 0x81U && third >= 0xA6U && third <= 0xA9U);
  }
  return first == 0x7FU;
}

/// Returns `text` with \xNN in place of bytes outside UTF-8, is_hidden_control() characters, and
/// characters with a first byte for which `is_hidden` returns true.
template <class IsHidden>
std::string escaped(std::string_view text, IsHidden is_hidden) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_bytes(text, at);
    const bool is_shown =
        length > 0 && !is_hidden(byte_at(text, at)) && !is_hidden_control(text, at, length);
    const std::size_t end = at + (length == 0 ? 1 : length);
    for (; at < end; ++at) {
      const unsigned char byte = byte_at(text, at);
      if (is_shown) {
        out += text[at];
      } else {
        out += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 0x0FU]};
      }
    }
  }
  return out;
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
  return escaped(text, [](unsigned char first) { return first < 0x20U || first == '\\'; });
}

std::string printable(std::string_view text) {
  return escaped(
      text, [](unsigned char first) { return first < 0x20U && first != '\n' && first != '\t'; });
}

}  // namespace vantage
