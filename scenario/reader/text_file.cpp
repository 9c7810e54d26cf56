#include "scenario/reader/text_file.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage::scenario {
namespace {

void check_size(const std::string& text, const std::string& name, const TextRule& rule) {
  if (text.size() > rule.bytes_max) {
    throw StartupError(fmt::format("{}: must be at most {} bytes", name, rule.bytes_max));
  }
}

}  // namespace

std::string read_text_file(const std::string& path, const TextRule& rule) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw StartupError(path + ": no such file");
  }
  if (std::filesystem::is_directory(status)) {
    throw StartupError(fmt::format("{}: is a directory; expected {} file", path, rule.expected));
  }
  std::string text;
  std::ifstream file;
  if (rule.may_be_pipe || std::filesystem::is_regular_file(status)) {
    file.open(path, std::ios::binary);
  }
  std::array<char, std::size_t{1} << 16> part{};
  while (text.size() <= rule.bytes_max && file.is_open() && file) {
    file.read(part.data(), part.size());
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.is_open() || file.bad()) {
    throw StartupError(path + ": cannot be read");
  }
  check_size(text, path, rule);
  return text;
}

void check_text(const std::string& text, const std::string& name, const TextRule& rule) {
  check_size(text, name, rule);
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
    if (first == '\t' && !rule.may_have_tabs) {
      refuse("tab character; use spaces");
    }
    if ((first < 0x20 && first != '\n' && first != '\r' && first != '\t') || first == 0x7F) {
      refuse(fmt::format("control character 0x{:02x}", first));
    }
    line += first == '\n' ? 1 : 0;
    at += length;
  }
}

}  // namespace vantage::scenario
