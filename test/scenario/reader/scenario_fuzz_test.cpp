#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

std::vector<std::string> lab_lines() {
  std::ifstream file(VANTAGE_SOURCE_DIR "/config/lab.yaml");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    // Removes comments, since an edit inside one would test nothing.
    line.resize(std::min(line.size(), line.find(" #")));
    if (!line.empty() && line.front() != '#') {
      lines.push_back(line + "\n");
    }
  }
  return lines;
}

/// Tokens that people, editors and bit errors put into files.
const std::vector<std::string> kTokens = {"-1",
                                          "0",
                                          "1e308",
                                          "1e-308",
                                          ".nan",
                                          ".inf",
                                          "~",
                                          "null",
                                          "true",
                                          "[]",
                                          "{}",
                                          "[",
                                          "]",
                                          "{",
                                          "}",
                                          ":",
                                          ": ",
                                          "- ",
                                          "? ",
                                          "&a ",
                                          "*a ",
                                          "<<: ",
                                          "!!",
                                          "!x ",
                                          "|",
                                          ">",
                                          "'",
                                          "\"",
                                          "#",
                                          "@",
                                          "%",
                                          "`",
                                          ",",
                                          "\n",
                                          "\r\n",
                                          "\t",
                                          "  ",
                                          "---",
                                          "...",
                                          "\xEF\xBB\xBF",
                                          "\xC3",
                                          "\xFF",
                                          "name: lab\n",
                                          "q: 1",
                                          "Q1",
                                          "_deg",
                                          "_rad",
                                          "_mm",
                                          "999999999999999999999"};

class Mutator {
 public:
  explicit Mutator(unsigned seed) : rng_(seed) {}

  std::string mutate(std::vector<std::string> lines) {
    for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
      const std::size_t at = below(lines.size());
      switch (below(4)) {
        case 0:
          lines[at].clear();
          break;
        case 1:
          lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(below(lines.size())), lines[at]);
          break;
        case 2:
          std::swap(lines[at], lines[below(lines.size())]);
          break;
        default:
          edit_text(lines[at]);
      }
    }
    std::string text;
    for (const std::string& line : lines) {
      text += line;
    }
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(rng_() % n); }

  void edit_text(std::string& line) {
    const std::string& token = kTokens[below(kTokens.size())];
    const std::size_t at = below(line.size() + 1);
    const std::size_t colon = line.find(": ");
    switch (below(4)) {
      case 0:
        line.insert(at, token);
        break;
      case 1:
        line.replace(at, below(4), token);
        break;
      case 2:
        line.insert(at, 1, static_cast<char>(below(256)));
        break;
      default:  // another value under the same key
        line = (colon == std::string::npos ? line : line.substr(0, colon + 2)) + token + "\n";
    }
  }

  std::mt19937_64 rng_;
};

class MutatedLab : public testing::TestWithParam<unsigned> {};

TEST_P(MutatedLab, IsReadOrRefusedWithFileAndLine) {
  constexpr int kEdits = 1000;
  const std::vector<std::string> lines = lab_lines();
  Mutator mutator(GetParam());
  int refused = 0;
  for (int i = 0; i < kEdits; ++i) {
    const std::string text = mutator.mutate(lines);
    try {
      const Scenario scenario = parse_scenario(text, "lab.yaml");
      EXPECT_FALSE(scenario.robots.empty());
      EXPECT_FALSE(scenario.targets.empty());
    } catch (const StartupError& error) {
      ++refused;
      const std::string message = error.what();
      std::istringstream after(message.substr(std::min<std::size_t>(message.size(), 9)));
      int line = 0;
      EXPECT_TRUE(message.rfind("lab.yaml:", 0) == 0 && after >> line && line >= 1) << message;
    } catch (const std::exception& other) {
      ADD_FAILURE() << other.what() << "\n" << text;
    }
  }
  // Most edits break the file; some (a swapped pair of keys, another number) do not.
  EXPECT_GT(refused, kEdits / 2);
  EXPECT_LT(refused, kEdits);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MutatedLab, testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace vantage::scenario
