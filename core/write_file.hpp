#pragma once

#include <string>
#include <string_view>

namespace vantage {

/// Writes `text` to `path` whole: under another name beside it first, so that whoever opens `path`
/// finds the old text or the new one, never a part. What is there and no regular file (/dev/stdout)
/// is written as it is.
/// @throws std::runtime_error "PATH: cannot be written: REASON"; what `path` held is then still
/// there
void write_file(const std::string& path, std::string_view text);

/// For what is written only at the end of long work: that a file can be made at `path`, or the one
/// there written, as far as that can be told before.
/// @throws StartupError "PATH: cannot be written: REASON"
void require_writable(const std::string& path);

}  // namespace vantage
