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

/// A file that is added to at its end. Each call may wait for the disk, for seconds when that is
/// slow. Errors name the file and the reason.
class AppendFile {
 public:
  AppendFile() = default;
  virtual ~AppendFile() = default;
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;
  AppendFile(AppendFile&&) = delete;
  AppendFile& operator=(AppendFile&&) = delete;

  /// Adds the first of `bytes`, one at least; how many. What was added outlives this process.
  virtual Result<std::size_t> append(std::span<const std::uint8_t> bytes) = 0;
  /// Returns once what was added outlives a power cut, the file's name included; may be called
  /// while another thread adds.
  virtual std::optional<Error> sync() = 0;
  /// Cuts off what lies beyond the first `size_bytes`.
  virtual std::optional<Error> cut(std::uint64_t size_bytes) = 0;
  [[nodiscard]] virtual std::uint64_t size_bytes() const = 0;
  /// What its file system has left for us; nullopt when that cannot be told.
  [[nodiscard]] virtual std::optional<std::uint64_t> free_bytes() const = 0;
};

/// What to do with a file that is there already.
enum class Existing { kRefuse, kAppend, kReplace };

using OpenFile =
    std::function<Result<std::unique_ptr<AppendFile>>(const std::string& path, Existing existing)>;

/// Opens, or makes, the file at `path` on this machine.
Result<std::unique_ptr<AppendFile>> open_append_file(const std::string& path, Existing existing);

/// "lab.lcmlog", 3 → "lab-3.lcmlog".
std::string numbered_path(const std::string& path, int number);
/// `path` itself where nothing is there, else the first of its numbered ones from 2 on.
std::string unused_path(const std::string& path);

/// What is free for a file at `path`, by its file system; nullopt when that cannot be told.
std::optional<std::uint64_t> free_bytes_for(const std::string& path);

}  // namespace vantage::logs
