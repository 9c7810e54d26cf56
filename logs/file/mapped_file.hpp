#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace vantage::logs {

struct Mapping;  ///< what the signal handler knows of a MappedFile

/// A file's bytes, mapped for reading: what is not touched is not read, so a log larger than the
/// memory is no trouble. The length is that of the moment of opening.
///
/// When the file becomes shorter while it is mapped, or its disk fails, the missing bytes are read
/// as zeros from then on, and require_uncut() throws. (The system reports this by SIGBUS, which the
/// first MappedFile of a process handles; faults in other memory go to the handler before it.)
class MappedFile {
 public:
  /// @throws StartupError when `path` cannot be read or is not a file.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {data_, size_bytes_}; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  const std::uint8_t* data_ = nullptr;
  std::size_t size_bytes_ = 0;
  Mapping* mapping_ = nullptr;  ///< null for an empty file
};

/// True once any MappedFile of this process has lost bytes. Cost: one load.
bool is_any_cut();

/// Throws std::runtime_error when `bytes` begin in a MappedFile that has become shorter than it was
/// when it was opened. Other memory passes. Asks the file system.
void require_uncut(std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs
