#include "scenario/reader/yaml_document.hpp"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::scenario {
namespace {

constexpr std::size_t kTextMaxBytes = std::size_t{1} << 20;

/// yaml-cpp replaces bad bytes silently and reads tabs in ways that surprise.
void check_characters(const std::string& text, const std::string& name) {
  int line = 1;
  const auto refuse = [&](const std::string& what) {
    throw StartupError(fmt::format("{}:{}: {}", name, line, what));
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = text[at] == '\0' ? 1 : utf8_bytes(text, at);
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

}  // namespace vantage::scenario
