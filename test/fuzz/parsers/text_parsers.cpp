#include "test/fuzz/parsers/text_parsers.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/check.hpp"
#include "core/utf8.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "tools/plan/problem_json.hpp"

namespace vantage::test {
namespace {

/// Calls `read` on `input`; an error must be one line of text that begins with the file's name.
template <class Read>
void read_or_refuse(std::span<const std::uint8_t> input, const Read& read) {
  try {
    static_cast<void>(read(std::string(input.begin(), input.end())));
  } catch (const StartupError& error) {
    const std::string_view words = error.what();
    if (!words.starts_with("fuzzed:") || words.find('\n') != words.npos || !is_utf8(words)) {
      std::fprintf(stderr, "broken promise: a refusal is a line that names the file: %s\n",
                   error.what());
      std::abort();
    }
  }
}

}  // namespace

void fuzz_scenario(std::span<const std::uint8_t> input) {
  read_or_refuse(input,
                 [](const std::string& text) { return scenario::parse_scenario(text, "fuzzed"); });
}

void fuzz_problem(std::span<const std::uint8_t> input) {
  read_or_refuse(input,
                 [](const std::string& text) { return tools::parse_problem(text, "fuzzed"); });
}

}  // namespace vantage::test
