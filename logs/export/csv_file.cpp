#include "logs/export/csv_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/check.hpp"

namespace vantage::logs {
namespace {

void cut_to_last_line(const std::string& path) {
  std::error_code error;
  auto size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  for (char last = '\0'; !error && size > 0; --size) {
    in.seekg(static_cast<std::streamoff>(size) - 1);
    if (!in.get(last) || last == '\n') {
      break;
    }
  }
  std::filesystem::resize_file(path, size, error);
}

}  // namespace

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    return std::string(text);
  }
  std::string out = "\"";
  for (const char c : text) {
    out += c == '"' ? "\"\"" : std::string(1, c);
  }
  return out + '"';
}

CsvFile::CsvFile(std::string path, std::string_view header)
    : path_(std::move(path)), out_(path_, std::ios::binary) {
  if (!out_) {
    throw StartupError(path_ + ": cannot be written: " + std::strerror(errno));
  }
  out_ << header;
}

void CsvFile::note_failure() {
  if (failure_.empty()) {
    failure_ = path_ + ": cannot be written: " + std::strerror(errno);
  }
}

bool CsvFile::write(std::string_view lines) {
  if (failure_.empty() && !(out_ << lines)) {
    note_failure();
  }
  return failure_.empty();
}

void CsvFile::close() {
  if (!out_.flush()) {
    note_failure();
  }
  out_.close();
  if (!failure_.empty()) {
    cut_to_last_line(path_);
  }
}

}  // namespace vantage::logs
