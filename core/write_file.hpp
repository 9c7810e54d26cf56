#pragma once

#include <string>
#include <string_view>

namespace vantage {

/// Writes `text` to `path` atomically: it writes a temporary file in the same folder and renames
/// it, so that readers find the old or the new text, never a part. An existing path that is not a
/// regular file (/dev/stdout) is written directly.
/// @throws std::runtime_error "PATH: cannot be written: REASON"; the previous content is then
/// unchanged
void write_file(const std::string& path, std::string_view text);

/// Checks, without writing, that write_file() is likely to succeed for `path`. Call this function
/// before long computations.
/// @throws StartupError "PATH: cannot be written: REASON"
void require_writable(const std::string& path);

}  // namespace vantage
