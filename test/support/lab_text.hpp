#pragma once

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::test {

/// A change of a text: the first occurrence of `was` is replaced by `becomes`.
struct TextEdit {
  std::string was;
  std::string becomes;
};

/// Returns the text of config/lab.yaml with `edits`, one after the other; fails the test if a text
/// to be replaced is absent.
inline std::string lab_with(const std::vector<TextEdit>& edits) {
  std::ifstream file(VANTAGE_SOURCE_DIR "/config/lab.yaml", std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (const TextEdit& edit : edits) {
    const std::size_t at = text.find(edit.was);
    EXPECT_NE(at, std::string::npos) << "lab.yaml has changed: no '" << edit.was << "'";
    if (at != std::string::npos) {
      text.replace(at, edit.was.size(), edit.becomes);
    }
  }
  return text;
}

}  // namespace vantage::test
