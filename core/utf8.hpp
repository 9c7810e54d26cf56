#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vantage {

/// Bytes of the UTF-8 character that begins at `at` (no overlong form, no surrogate); 0 when none
/// does. NUL is none here. Source: Unicode 15, table 3-7.
std::size_t utf8_bytes(std::string_view text, std::size_t at);
/// True for UTF-8 (no overlong forms, no surrogates) without a NUL; control characters may be in
/// it.
bool is_utf8(std::string_view text);

/// Returns `text` as UTF-8 of one line that a person can read and JSON can carry: bytes that are no
/// UTF-8, control characters (printable()) and the backslash become \xNN. Different texts stay
/// different.
std::string readable(std::string_view text);

/// Returns `text` as it may be written to a terminal. Bytes outside UTF-8 and control
/// characters become \xNN: C0 except line feed and tab, DEL, C1, line separators and those that
/// change the direction of writing. Text from the network or a file passes through here or
/// readable() before it reaches a terminal.
std::string printable(std::string_view text);

}  // namespace vantage
