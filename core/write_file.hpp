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

/// Checks that write_file() can create or replace the file at `path`, as far as this can be known.
/// To be called before long work.
/// @throws StartupError "PATH: cannot be written: REASON"
void require_writable(const std::string& path);

}  // namespace vantage
