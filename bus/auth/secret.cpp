#include "bus/auth/secret.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::bus::auth {
namespace {

std::string reason(int error) { return std::system_category().message(error); }

/// File descriptor that is closed on destruction.
class File {
 public:
  explicit File(int fd) : fd_(fd) {}
  ~File() {
    if (fd_ >= 0) {
      close(fd_);
    }
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  File(File&&) = delete;
  File& operator=(File&&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

/// Reads the secret in `file` into `out`. Returns the error text; empty if there was no error.
std::string fault_of_reading(const std::string& file, std::span<std::uint8_t> out,
                             const std::string& what) {
  const File opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  if (opened.fd() < 0 || fstat(opened.fd(), &status) != 0) {
    return "cannot read the " + what + ": " + reason(errno);
  }
  if (!S_ISREG(status.st_mode) || status.st_size != static_cast<off_t>(out.size())) {
    return "the file has " + std::to_string(status.st_size) + " bytes; the " + what +
           " must have " + std::to_string(out.size()) + " bytes";
  }
  if (status.st_uid != geteuid()) {
    return "the " + what + " belongs to another user; it must belong to this user";
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return "other users may read or change the " + what + "; chmod 600 " + file;
  }
  const ssize_t got = read(opened.fd(), out.data(), out.size());
  if (got != static_cast<ssize_t>(out.size())) {
    return "cannot read the " + what + ": " + (got < 0 ? reason(errno) : "the file is truncated");
  }
  return "";
}

}  // namespace

void start_sodium() {
  [[maybe_unused]] static const bool is_ready = [] {
    if (sodium_init() < 0) {
      throw StartupError("libsodium cannot be initialised");
    }
    return true;
  }();
}

void Secret::Wipe::operator()(std::uint8_t* bytes) const { sodium_free(bytes); }

Secret::Secret(std::size_t size) : size_(size) {
  start_sodium();
  bytes_.reset(static_cast<std::uint8_t*>(sodium_malloc(size)));
  if (bytes_ == nullptr) {
    throw StartupError("no memory for a secret of " + std::to_string(size) +
                       " bytes: " + reason(errno));
  }
  sodium_memzero(bytes_.get(), size);
}

void read_secret_file(const std::string& file, std::span<std::uint8_t> out,
                      const std::string& what) {
  const std::string fault = fault_of_reading(file, out, what);
  if (!fault.empty()) {
    sodium_memzero(out.data(), out.size());
    throw StartupError(file + ": " + fault);
  }
}

void write_secret_file(const std::string& file, std::span<const std::uint8_t> bytes) {
  constexpr mode_t kOursAlone = S_IRUSR | S_IWUSR;
  const File made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOursAlone));
  if (made.fd() < 0) {
    throw StartupError(file + ": cannot be created: " + reason(errno));
  }
  const ssize_t put = write(made.fd(), bytes.data(), bytes.size());
  if (put != static_cast<ssize_t>(bytes.size()) || fchmod(made.fd(), kOursAlone) != 0 ||
      fsync(made.fd()) != 0) {
    const std::string why = reason(errno);
    unlink(file.c_str());
    throw StartupError(file + ": cannot be written: " + why);
  }
}

}  // namespace vantage::bus::auth
