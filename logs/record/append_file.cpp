#include "logs/record/append_file.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace vantage::logs {
namespace {

constexpr mode_t kMode = 0644;

std::string reason() { return std::system_category().message(errno); }

std::string folder_of(const std::string& path) {
  const auto folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

class DiskFile : public AppendFile {
 public:
  DiskFile(int fd, std::string path, std::uint64_t size_bytes)
      : fd_(fd), path_(std::move(path)), size_bytes_(size_bytes) {}
  ~DiskFile() override { ::close(fd_); }
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;
  DiskFile(DiskFile&&) = delete;
  DiskFile& operator=(DiskFile&&) = delete;

  Result<std::size_t> append(std::span<const std::uint8_t> bytes) override {
    ssize_t taken = -1;
    do {
      taken = ::write(fd_, bytes.data(), bytes.size());
    } while (taken < 0 && errno == EINTR);
    if (taken <= 0) {
      return Error{path_ +
                   ": cannot be written: " + (taken < 0 ? reason() : "the disk accepted no bytes")};
    }
    size_bytes_ += static_cast<std::uint64_t>(taken);
    return static_cast<std::size_t>(taken);
  }

  std::optional<Error> sync() override {
    if (::fdatasync(fd_) != 0) {
      return Error{path_ + ": the last data may not have been written to the disk: " + reason()};
    }
    // Also syncs the folder once: without a directory entry the file would be lost.
    if (!std::exchange(is_named_, true)) {
      const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      const bool is_synced = folder >= 0 && ::fsync(folder) == 0;
      const std::string why = is_synced ? "" : reason();
      if (folder >= 0) {
        ::close(folder);
      }
      if (!is_synced) {
        return Error{path_ + ": its folder entry may not have been written to the disk: " + why};
      }
    }
    return std::nullopt;
  }

  std::optional<Error> cut(std::uint64_t size_bytes) override {
    if (::ftruncate(fd_, static_cast<off_t>(size_bytes)) != 0) {
      return Error{path_ + ": its unfinished end cannot be cut off: " + reason()};
    }
    size_bytes_ = size_bytes;
    return std::nullopt;
  }

  [[nodiscard]] std::uint64_t size_bytes() const override { return size_bytes_; }

  [[nodiscard]] std::optional<std::uint64_t> free_bytes() const override {
    struct statvfs space {};
    if (::fstatvfs(fd_, &space) != 0) {
      return std::nullopt;
    }
    return std::uint64_t{space.f_bavail} * space.f_frsize;
  }

 private:
  int fd_;
  std::string path_;
  std::uint64_t size_bytes_;
  bool is_named_ = false;  ///< true once the file's directory entry is on the disk
};

}  // namespace

Result<std::unique_ptr<AppendFile>> open_append_file(const std::string& path, Existing existing) {
  const int how = existing == Existing::kRefuse    ? O_EXCL
                  : existing == Existing::kReplace ? O_TRUNC
                                                   : 0;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | how, kMode);
  if (fd < 0) {
    return Error{path + ": " +
                 (errno == EEXIST ? "exists already, and no log is overwritten"
                                  : "cannot be written: " + reason())};
  }
  struct stat status {};
  if (::fstat(fd, &status) != 0) {
    const std::string why = reason();
    ::close(fd);
    return Error{path + ": " + why};
  }
  return std::unique_ptr<AppendFile>(
      std::make_unique<DiskFile>(fd, path, static_cast<std::uint64_t>(status.st_size)));
}

std::string numbered_path(const std::string& path, int number) {
  const std::filesystem::path whole(path);
  const auto name = whole.stem().string() + "-" + std::to_string(number);
  return (whole.parent_path() / name).string() + whole.extension().string();
}

std::string unused_path(const std::string& path) {
  std::string out = path;
  std::error_code error;
  for (int number = 2; std::filesystem::exists(std::filesystem::symlink_status(out, error));
       ++number) {
    out = numbered_path(path, number);
  }
  return out;
}

std::optional<std::uint64_t> free_bytes_for(const std::string& path) {
  std::error_code error;
  const auto space = std::filesystem::space(folder_of(path), error);
  return error ? std::nullopt : std::optional<std::uint64_t>(space.available);
}

}  // namespace vantage::logs
