#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vantage {

/// Returns the number of bytes of the UTF-8 character that begins at `at` (no overlong form, no
/// surrogate); 0 if there is none. NUL does not count as a character. Source: Unicode 15, table
/// 3-7.
std::size_t utf8_bytes(std::string_view text, std::size_t at);
/// True for UTF-8 (no overlong forms, no surrogates) without a NUL; control characters are allowed.
bool is_utf8(std::string_view text);

/// Returns `text` as one line of UTF-8 that is readable and valid in JSON. Bytes outside UTF-8,
/// control characters (printable()) and the backslash become `\\xNN`. Different texts give
/// different results.
std::string readable(std::string_view text);

/// Returns `text` with unsafe bytes escaped for a terminal. Bytes outside UTF-8 and control
/// characters become `\\xNN`. Control characters are C0 except line feed and tab, DEL, C1, line
/// separators and characters that change the writing direction. Pass text from the network or a
/// file through this function or readable() before printing.
std::string printable(std::string_view text);

}  // namespace vantage
