#pragma once

#include <string>

#include "scenario/reader/yaml_value.hpp"

namespace vantage::scenario {

/// The whole content of the regular file at `path`.
/// @throws StartupError when there is none, or it is a directory, unreadable or over 1 MiB.
std::string read_text_file(const std::string& path);

/// The one YAML document in `text`; `name` stands for the file in messages.
/// @throws StartupError "name:line: …" for bytes that are not UTF-8 text, tabs, control
///         characters, YAML that does not parse, none or several documents.
Value parse_document(const std::string& text, const std::string& name);

}  // namespace vantage::scenario
