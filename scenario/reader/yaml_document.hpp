#pragma once

#include <string>

#include "scenario/reader/value.hpp"

namespace vantage::scenario {

/// The one YAML document in `text`; `name` stands for the file in messages.
/// @throws StartupError as check_text(), and "name:line: …" for tabs, YAML that does not parse,
///         none or several documents.
Value parse_yaml(const std::string& text, const std::string& name);

}  // namespace vantage::scenario
