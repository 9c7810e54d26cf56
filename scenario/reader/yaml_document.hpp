#pragma once

#include <string>

#include "scenario/reader/value.hpp"

namespace vantage::scenario {

/// Parses `text`, which must be one YAML document. `name` is used as the file name in error
/// messages.
/// @throws StartupError as check_text(), and "name:line: …" for tabs, invalid YAML, no document or
///         several documents.
Value parse_yaml(const std::string& text, const std::string& name);

}  // namespace vantage::scenario
