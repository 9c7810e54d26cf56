#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vantage::scenario {

/// What a text is to be, in the words of whoever refuses it.
struct TextRule {
  std::string_view expected;  ///< "a scenario"
  std::size_t bytes_max = 0;
  bool may_have_tabs = false;
  bool may_be_pipe = false;
};

inline constexpr TextRule kScenarioText{.expected = "a scenario",
                                        .bytes_max = std::size_t{1} << 20};

/// The whole content of the file at `path`.
/// @throws StartupError when there is none, or it is a directory, unreadable or too large.
std::string read_text_file(const std::string& path, const TextRule& rule = kScenarioText);

/// @throws StartupError "name:line: …" when `text`, of the file `name`, is too large, or has bytes
///         that are not UTF-8 text, or control characters.
void check_text(const std::string& text, const std::string& name, const TextRule& rule);

}  // namespace vantage::scenario
