#include "tools/console/terminal.hpp"

#include <algorithm>
#include <array>

#include <poll.h>
#include <unistd.h>

namespace vantage::tools {

std::size_t key_bytes(std::string_view typed) {
  if (typed.empty() || typed[0] != '\x1b') {
    return std::min(typed.size(), std::size_t{1});
  }
  if (typed.size() == 1) {
    return 0;
  }
  if (typed[1] != '[' && typed[1] != 'O') {
    return 1;  // the key ESC itself
  }
  std::size_t at = typed.substr(0, 3) == "\x1b[[" ? 3 : 2;
  while (at < typed.size() && ((typed[at] >= '0' && typed[at] <= '9') || typed[at] == ';')) {
    ++at;
  }
  if (at == typed.size()) {
    return 0;
  }
  return typed[at] >= '@' && typed[at] <= '~' ? at + 1 : at;
}

Terminal::Terminal() {
  termios settings{};
  if (::isatty(STDIN_FILENO) == 1 && ::tcgetattr(STDIN_FILENO, &settings) == 0) {
    saved_ = settings;
    // Disables keys that would stop the output (Ctrl-S) or the process (Ctrl-Z, Ctrl-\).
    settings.c_iflag &= ~static_cast<tcflag_t>(IXON | IXOFF | IXANY);
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    settings.c_cc[VSUSP] = _POSIX_VDISABLE;
    settings.c_cc[VQUIT] = _POSIX_VDISABLE;
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
    const std::size_t bytes = std::max(key_bytes(pending_), is_closed_ ? std::size_t{1} : 0);
    if (bytes == 0) {
      return std::nullopt;
    }
    const std::string key = pending_.substr(0, bytes);
    pending_.erase(0, bytes);
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
