#include "logs/file/mapped_file.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::logs {

MappedFile::MappedFile(const std::string& path) : path_(path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (fd < 0 || ::fstat(fd, &status) != 0) {
    const std::string why = std::strerror(errno);
    if (fd >= 0) {
      ::close(fd);
    }
    throw StartupError(path + ": cannot be read: " + why);
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(fd);
    throw StartupError(path + ": not a file");
  }
  size_bytes_ = static_cast<std::size_t>(status.st_size);
  void* mapped =
      size_bytes_ == 0 ? nullptr : ::mmap(nullptr, size_bytes_, PROT_READ, MAP_PRIVATE, fd, 0);
  ::close(fd);
  if (mapped == MAP_FAILED) {
    throw StartupError(path + ": cannot be mapped: " + std::strerror(errno));
  }
  data_ = static_cast<const std::uint8_t*>(mapped);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)),
      data_(std::exchange(other.data_, nullptr)),
      size_bytes_(std::exchange(other.size_bytes_, 0)) {}

MappedFile::~MappedFile() {
  if (data_ != nullptr) {
    ::munmap(const_cast<std::uint8_t*>(data_), size_bytes_);  // NOLINT: munmap is not const-correct
  }
}

}  // namespace vantage::logs
