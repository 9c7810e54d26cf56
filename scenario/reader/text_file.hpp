#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vantage::scenario {

/// Requirements on a text file.
struct TextRule {
  std::string_view expected;  ///< kind of file in error messages: "a scenario"
  std::size_t bytes_max = 0;
  bool may_have_tabs = false;
  bool may_be_pipe = false;
};

inline constexpr TextRule kScenarioText{.expected = "a scenario",
                                        .bytes_max = std::size_t{1} << 20};

/// Returns the content of the file at `path`. @throws StartupError when the file cannot be read or
/// is too large.
std::string read_text_file(const std::string& path, const TextRule& rule = kScenarioText);

/// Checks `text` of the file `name`.
/// @throws StartupError "name:line: …" when the text is too large, is not UTF-8, or contains
///         control characters.
void check_text(const std::string& text, const std::string& name, const TextRule& rule);

}  // namespace vantage::scenario
