#include "logs/file/log_index.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "logs/file/survey_bytes.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kFormat = 0x564C494E44455804ULL;  // "VLINDEX" and format version 4
constexpr std::size_t kEndBytes = 4096;
constexpr std::size_t kHashBytes = 8;  ///< hash of all preceding bytes, at the end of the index

std::uint64_t hash_of(std::span<const std::uint8_t> bytes) {  // FNV-1a hash
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const std::uint8_t byte : bytes) {
    hash = (hash ^ byte) * 0x100000001b3ULL;
  }
  return hash;
}

/// Returns the bytes that identify this log. Its index begins with these bytes.
Bytes identity_of(const std::string& path, std::span<const std::uint8_t> log) {
  std::error_code error;
  const auto changed = fs::last_write_time(path, error).time_since_epoch().count();
  const std::size_t end = std::min(kEndBytes, log.size());
  Bytes out;
  for (const std::uint64_t number :
       {kFormat, std::uint64_t{log.size()}, static_cast<std::uint64_t>(changed),
        hash_of(log.first(end)), hash_of(log.last(end))}) {
    append_big_endian(number, sizeof number, out);
  }
  return out;
}

/// Returns an upper bound of the size of the index for a log of `log_bytes`.
std::size_t index_bytes_max(std::size_t log_bytes) {
  return (std::size_t{1} << 20U) + 8 * log_bytes;
}

/// Returns the content of the regular file at `path`; empty if there is none or if it is larger
/// than `bytes_max`.
Bytes read_file(const std::string& path, std::size_t bytes_max) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > bytes_max || error) {
    return {};
  }
  std::ifstream in(path, std::ios::binary);
  Bytes out(static_cast<std::size_t>(fs::file_size(path, error)));
  in.read(reinterpret_cast<char*>(out.data()), std::ssize(out));
  out.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return out;
}

std::string index_path(const std::string& log_path) { return log_path + ".index"; }

}  // namespace

std::optional<LogSurvey> load_index(const std::string& log_path,
                                    std::span<const std::uint8_t> log) {
  const Bytes whole = read_file(index_path(log_path), index_bytes_max(log.size()));
  const Bytes identity = identity_of(log_path, log);
  if (whole.size() < identity.size() + kHashBytes ||
      !std::equal(identity.begin(), identity.end(), whole.begin())) {
    return std::nullopt;
  }
  const auto content = std::span(whole).first(whole.size() - kHashBytes);
  if (read_big_endian(content.data() + content.size(), kHashBytes) != hash_of(content)) {
    return std::nullopt;
  }
  return survey_from(content.subspan(identity.size()), log.size());
}

bool save_index(const std::string& log_path, std::span<const std::uint8_t> log,
                const LogSurvey& survey) {
  Bytes content = identity_of(log_path, log);
  append_survey(survey, content);
  append_big_endian(hash_of(content), kHashBytes, content);
  // Write to a temporary name first: a process that opens the log at the same time must find a
  // complete index or none.
  const std::string temporary_path = index_path(log_path) + "." + std::to_string(::getpid());
  {
    std::ofstream out(temporary_path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(content.data()), std::ssize(content));
    if (!out.flush()) {
      std::remove(temporary_path.c_str());
      return false;
    }
  }
  return std::rename(temporary_path.c_str(), index_path(log_path).c_str()) == 0;
}

IndexedLog::IndexedLog(const std::string& path, const std::function<void(double)>& progress)
    : file_(path) {
  if (auto known = load_index(path, bytes())) {
    survey_ = std::move(*known);
    was_indexed_ = true;
    return;
  }
  survey_ = survey_log(bytes(), progress);
  if (survey_.scan.events > 0) {  // a file without events is not a log
    static_cast<void>(save_index(path, bytes(), survey_));
  }
}

LogScan IndexedLog::scan() const { return LogScan(bytes(), check_wire_data); }

LogScan IndexedLog::scan_from(Time from) const {
  return LogScan(bytes(), check_wire_data, seek_offset(bytes(), survey_, from));
}

}  // namespace vantage::logs
