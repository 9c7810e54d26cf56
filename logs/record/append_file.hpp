#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/result.hpp"

namespace vantage::logs {

/// Append-only file. Each call may block on the disk, for seconds if the disk is slow. Errors state
/// the file's name and the reason.
class AppendFile {
 public:
  AppendFile() = default;
  virtual ~AppendFile() = default;
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;
  AppendFile(AppendFile&&) = delete;
  AppendFile& operator=(AppendFile&&) = delete;

  /// Appends a prefix of `bytes` and returns its length, at least 1. Appended bytes survive the end
  /// of this process.
  virtual Result<std::size_t> append(std::span<const std::uint8_t> bytes) = 0;
  /// Returns once all appended bytes and the file's name would survive a power failure. May be
  /// called while another thread appends.
  virtual std::optional<Error> sync() = 0;
  /// Truncates the file to `size_bytes`.
  virtual std::optional<Error> cut(std::uint64_t size_bytes) = 0;
  [[nodiscard]] virtual std::uint64_t size_bytes() const = 0;
  /// Returns the free space of the file system for this user; nullopt if unknown.
  [[nodiscard]] virtual std::optional<std::uint64_t> free_bytes() const = 0;
};

/// Treatment of an existing file.
enum class Existing { kRefuse, kAppend, kReplace };

using OpenFile =
    std::function<Result<std::unique_ptr<AppendFile>>(const std::string& path, Existing existing)>;

/// Opens or creates the file at `path` on this machine.
Result<std::unique_ptr<AppendFile>> open_append_file(const std::string& path, Existing existing);

/// Returns `path` with a number: "lab-3.lcmlog" for "lab.lcmlog" and 3.
std::string numbered_path(const std::string& path, int number);
/// Returns `path` if no such file exists, else the first unused numbered_path() from 2 on.
std::string unused_path(const std::string& path);

/// Returns the free space of the file system of `path`; nullopt if unknown.
std::optional<std::uint64_t> free_bytes_for(const std::string& path);

}  // namespace vantage::logs
