#include "core/write_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage {
namespace {

std::string refusal(const std::string& path, int why) {
  return path + ": cannot be written: " + std::strerror(why);
}

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno != EINTR) {
      return false;
    }
    text.remove_prefix(count < 0 ? 0 : static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace

void write_file(const std::string& path, std::string_view text) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool is_whole =
      !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
  const std::string passing = is_whole ? path + "." + std::to_string(::getpid()) : path;
  const int descriptor = ::open(passing.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw std::runtime_error(refusal(path, errno));
  }
  bool is_written = write_all(descriptor, text);
  int why = errno;
  if (::close(descriptor) != 0 && is_written) {
    is_written = false;
    why = errno;
  }
  if (is_written && is_whole && ::rename(passing.c_str(), path.c_str()) != 0) {
    is_written = false;
    why = errno;
  }
  if (!is_written) {
    if (is_whole) {
      ::unlink(passing.c_str());
    }
    throw std::runtime_error(refusal(path, why));
  }
}

void require_writable(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw StartupError(refusal(path, EISDIR));
  }
  const auto folder = std::filesystem::absolute(path, error).parent_path();
  const bool is_there = std::filesystem::exists(path, error);
  if (!is_there && !std::filesystem::is_directory(folder, error)) {
    throw StartupError(refusal(path, std::filesystem::exists(folder, error) ? ENOTDIR : ENOENT));
  }
  if (::access(is_there ? path.c_str() : folder.c_str(), W_OK) != 0) {
    throw StartupError(refusal(path, errno));
  }
}

}  // namespace vantage
