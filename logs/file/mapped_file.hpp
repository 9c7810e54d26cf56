#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace vantage::logs {

/// A file's bytes, mapped for reading: what is not touched is not read, so a log larger than the
/// memory is no trouble. The length is that of the moment of opening; a file that is made shorter
/// while it is open must not be read past its new end (the system ends the process with SIGBUS).
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
};

}  // namespace vantage::logs
