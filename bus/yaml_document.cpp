#include "bus/yaml_document.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::bus {
namespace {

constexpr std::size_t kTextMaxBytes = std::size_t{1} << 20;

/// Bytes of the well-formed UTF-8 character that starts at `at`; 0 when there is none.
/// Source: Unicode 15, table 3-7.
std::size_t utf8_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U;
  };
  const auto continues = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) {
    return 1;
  }
  if (first >= 0xC2 && first <= 0xDF) {
    return continues(1) ? 2 : 0;
  }
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned low = first == 0xE0 ? 0xA0 : 0x80;   // no overlong forms
    const unsigned high = first == 0xED ? 0x9F : 0xBF;  // no surrogates
    return continues(1, low, high) && continues(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned low = first == 0xF0 ? 0x90 : 0x80;
    const unsigned high = first == 0xF4 ? 0x8F : 0xBF;  // nothing beyond U+10FFFF
    return continues(1, low, high) && continues(2) && continues(3) ? 4 : 0;
  }
  return 0;
}

/// yaml-cpp replaces bad bytes silently and reads tabs in ways that surprise.
void check_characters(const std::string& text, const std::string& name) {
  int line = 1;
  const auto refuse = [&](const std::string& what) {
    throw StartupError(fmt::format("{}:{}: {}", name, line, what));
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    if (length == 0) {
      refuse(fmt::format("byte 0x{:02x} is not UTF-8 text", first));
    }
    if (first == '\t') {
      refuse("tab character; use spaces");
    }
    if ((first < 0x20 && first != '\n' && first != '\r') || first == 0x7F) {
      refuse(fmt::format("control character 0x{:02x}", first));
    }
    line += first == '\n' ? 1 : 0;
    at += length;
  }
}

}  // namespace

std::string read_text_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw StartupError(path + ": no such file");
  }
  if (std::filesystem::is_directory(status)) {
    throw StartupError(path + ": is a directory; expected a scenario file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(status) || !file) {
    throw StartupError(path + ": cannot be read");
  }
  if (std::filesystem::file_size(path, error) > kTextMaxBytes) {
    throw StartupError(fmt::format("{}: must be at most {} bytes", path, kTextMaxBytes));
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Value parse_document(const std::string& text, const std::string& name) {
  if (text.size() > kTextMaxBytes) {
    throw StartupError(fmt::format("{}: must be at most {} bytes", name, kTextMaxBytes));
  }
  check_characters(text, name);
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& problem) {
    throw StartupError(
        fmt::format("{}:{}: not YAML: {}", name, std::max(problem.mark.line, 0) + 1, problem.msg));
  }
  if (documents.empty() || (documents.size() == 1 && documents.front().IsNull())) {
    throw StartupError(name + ":1: empty file; expected a scenario");
  }
  if (documents.size() > 1) {
    throw StartupError(fmt::format("{}:{}: a second document; a file holds one scenario", name,
                                   line_of(documents[1], 1)));
  }
  return {documents.front(), name, "", 1};
}

}  // namespace vantage::bus
