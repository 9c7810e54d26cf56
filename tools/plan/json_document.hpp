#pragma once

#include <string>

#include "scenario/reader/text_file.hpp"
#include "scenario/reader/value.hpp"

namespace vantage::tools {

inline constexpr scenario::TextRule kProblemText{.expected = "a planning problem",
                                                 .bytes_max = std::size_t{16} << 20,
                                                 .may_have_tabs = true,
                                                 .may_be_pipe = true};

/// The JSON in `text`, for the reader that scenario files have; `name` stands for the file in
/// messages. A number that is whole is one for Value::integer(), whether written 12 or 12.0.
/// @throws StartupError as scenario::check_text(), and "name:line:column: …" for what is no JSON.
scenario::Value parse_json(const std::string& text, const std::string& name);

}  // namespace vantage::tools
