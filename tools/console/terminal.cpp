#include "tools/console/terminal.hpp"

#include <array>

#include <poll.h>
#include <unistd.h>

namespace vantage::tools {

Terminal::Terminal() {
  termios settings{};
  if (::isatty(STDIN_FILENO) == 1 && ::tcgetattr(STDIN_FILENO, &settings) == 0) {
    saved_ = settings;
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &settings);
  }
}

Terminal::~Terminal() {
  if (saved_) {
    ::tcsetattr(STDIN_FILENO, TCSANOW, &*saved_);
  }
}

void Terminal::fill() {
  pollfd ready{STDIN_FILENO, POLLIN, 0};
  while (!is_closed_ && ::poll(&ready, 1, 0) > 0) {
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count <= 0) {
      is_closed_ = true;
      return;
    }
    pending_.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

std::optional<std::string> Terminal::read() {
  fill();
  if (pending_.empty()) {
    return std::nullopt;
  }
  if (is_interactive()) {
    const std::string key = pending_.substr(0, 1);
    pending_.erase(0, 1);
    return key;
  }
  const auto end = pending_.find('\n');
  if (end == std::string::npos && !is_closed_) {
    return std::nullopt;
  }
  const std::string line = pending_.substr(0, end);
  pending_.erase(0, end == std::string::npos ? end : end + 1);
  return line;
}

}  // namespace vantage::tools
