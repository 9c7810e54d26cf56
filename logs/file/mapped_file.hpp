#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace vantage::logs {

struct Mapping;  ///< data of a MappedFile that the signal handler uses

/// Bytes of a file, mapped for reading. Only the accessed parts are read, so a log may be larger
/// than the memory. The length is fixed when the file is opened.
///
/// If the file becomes shorter while it is mapped, or its disk fails, the missing bytes read as
/// zeros from then on, and require_not_truncated() throws. The system reports such accesses by
/// SIGBUS. The first MappedFile of a process installs a handler; faults in other memory are passed
/// to the previous handler.
class MappedFile {
 public:
  /// @throws StartupError if `path` cannot be read or is not a regular file.
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
bool is_any_truncated();

/// Throws std::runtime_error if `bytes` begin in a MappedFile that is shorter than when it was
/// opened. Accepts all other memory. Cost: one stat call.
void require_not_truncated(std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs
