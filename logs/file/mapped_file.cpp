#include "logs/file/mapped_file.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::logs {

/// Mapping that the signal handler can read. Mappings are reused but never freed, so that the
/// handler can walk the list at any time.
struct Mapping {
  std::atomic<const std::uint8_t*> data = nullptr;  ///< null: this mapping is not in use
  std::atomic<std::size_t> size_bytes = 0;
  std::atomic<bool> is_cut = false;
  Mapping* next = nullptr;  ///< constant once the mapping is in the list
  std::string path;         ///< not used by the handler
  struct stat status {};    ///< not used by the handler; state when the file was opened

  [[nodiscard]] bool has(const std::uint8_t* at) const {
    const std::uint8_t* begin = data.load();
    return begin != nullptr && at >= begin && at < begin + size_bytes.load();
  }
};

namespace {

std::atomic<int> cuts = 0;
std::atomic<Mapping*> newest_mapping = nullptr;
std::mutex mappings_mutex;  // protects everything that the handler does not read
struct sigaction handler_before {};
std::size_t page_bytes = 4096;

// Maps zeros over the missing part of the file, so that the interrupted read continues.
void on_bus_error(int signal, siginfo_t* info, void* context) {
  const int errno_before = errno;
  const auto* at = static_cast<const std::uint8_t*>(info->si_addr);
  for (Mapping* each = newest_mapping.load(); each != nullptr; each = each->next) {
    if (!each->has(at)) {
      continue;
    }
    const std::uint8_t* begin = each->data.load();
    const std::size_t kept = static_cast<std::size_t>(at - begin) / page_bytes * page_bytes;
    auto* lost = const_cast<std::uint8_t*>(begin + kept);  // NOLINT: mmap is not const-correct
    if (::mmap(lost, each->size_bytes.load() - kept, PROT_READ,
               MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED) {
      each->is_cut = true;
      ++cuts;
      errno = errno_before;
      return;
    }
  }
  errno = errno_before;
  if ((static_cast<unsigned>(handler_before.sa_flags) & unsigned{SA_SIGINFO}) != 0) {
    handler_before.sa_sigaction(signal, info, context);
  } else if (handler_before.sa_handler != SIG_DFL && handler_before.sa_handler != SIG_IGN) {
    handler_before.sa_handler(signal);
  } else {
    ::signal(SIGBUS, SIG_DFL);  // the access is repeated and terminates the process
  }
}

void handle_bus_errors() {
  page_bytes = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGBUS, &action, &handler_before);
}

// Registers a mapping. Must be called before its first byte is read.
Mapping* register_mapping(const std::string& path, const struct stat& status,
                          const std::uint8_t* data) {
  const std::lock_guard lock(mappings_mutex);
  if (newest_mapping == nullptr) {
    handle_bus_errors();
  }
  Mapping* mapping = newest_mapping;
  while (mapping != nullptr && mapping->data != nullptr) {
    mapping = mapping->next;
  }
  const bool is_new = mapping == nullptr;
  if (is_new) {
    mapping = new Mapping;  // NOLINT: never freed
    mapping->next = newest_mapping;
  }
  mapping->path = path;
  mapping->status = status;
  mapping->is_cut = false;
  mapping->size_bytes = static_cast<std::size_t>(status.st_size);
  mapping->data = data;
  if (is_new) {
    newest_mapping = mapping;
  }
  return mapping;
}

}  // namespace

bool is_any_truncated() { return cuts.load(std::memory_order_relaxed) > 0; }

void require_not_truncated(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mappings_mutex);
  for (const Mapping* each = newest_mapping; each != nullptr; each = each->next) {
    if (!each->has(bytes.data())) {
      continue;
    }
    struct stat now {};
    const bool is_same = ::stat(each->path.c_str(), &now) == 0 &&
                         now.st_dev == each->status.st_dev && now.st_ino == each->status.st_ino;
    const bool is_shorter = is_same && now.st_size < each->status.st_size;
    if (each->is_cut || is_shorter) {
      throw std::runtime_error(each->path +
                               ": became shorter while it was read, or its disk fails: it had " +
                               std::to_string(each->status.st_size) + " bytes" +
                               (is_same ? ", now " + std::to_string(now.st_size) : std::string()));
    }
    return;
  }
}

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
    throw StartupError(path + ": is not a regular file");
  }
  size_bytes_ = static_cast<std::size_t>(status.st_size);
  void* mapped =
      size_bytes_ == 0 ? nullptr : ::mmap(nullptr, size_bytes_, PROT_READ, MAP_PRIVATE, fd, 0);
  ::close(fd);
  if (mapped == MAP_FAILED) {
    throw StartupError(path + ": cannot be mapped: " + std::strerror(errno));
  }
  data_ = static_cast<const std::uint8_t*>(mapped);
  if (data_ != nullptr) {
    mapping_ = register_mapping(path, status, data_);
  }
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)),
      data_(std::exchange(other.data_, nullptr)),
      size_bytes_(std::exchange(other.size_bytes_, 0)),
      mapping_(std::exchange(other.mapping_, nullptr)) {}

MappedFile::~MappedFile() {
  if (data_ != nullptr) {
    {
      const std::lock_guard lock(mappings_mutex);
      mapping_->data = nullptr;
    }
    ::munmap(const_cast<std::uint8_t*>(data_), size_bytes_);  // NOLINT: munmap is not const-correct
  }
}

}  // namespace vantage::logs
