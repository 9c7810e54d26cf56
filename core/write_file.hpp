#pragma once

#include <string>
#include <string_view>

namespace vantage {

/// Writes `text` to `path` atomically: writes a file next to it first and renames it, so that
/// readers find the old or the new text, never a part. An existing path that is not a regular file
/// (/dev/stdout) is written directly.
/// @throws std::runtime_error "PATH: cannot be written: REASON"; the previous content is then kept
void write_file(const std::string& path, std::string_view text);

/// Checks before long work that write_file() can create or replace the file at `path`, as far as
/// this can be known.
/// @throws StartupError "PATH: cannot be written: REASON"
void require_writable(const std::string& path);

}  // namespace vantage
