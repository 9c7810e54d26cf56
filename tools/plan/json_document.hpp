#pragma once

#include <string>

#include "scenario/reader/text_file.hpp"
#include "scenario/reader/value.hpp"

namespace vantage::tools {

inline constexpr scenario::TextRule kProblemText{.expected = "a planning problem",
                                                 .bytes_max = std::size_t{16} << 20,
                                                 .may_have_tabs = true,
                                                 .may_be_pipe = true};

/// Parses JSON into the value tree that scenario files use. `name` is the file's name in messages.
/// Value::integer() accepts a whole number written as 12 or 12.0.
/// @throws StartupError as scenario::check_text(), and "name:line:column: …" for invalid JSON.
scenario::Value parse_json(const std::string& text, const std::string& name);

}  // namespace vantage::tools
