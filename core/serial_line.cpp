#include "core/serial_line.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

namespace vantage {
namespace {

std::optional<speed_t> speed_of(int baud) {
  struct Speed {
    int baud;
    speed_t speed;
  };
  static constexpr std::array<Speed, 9> kSpeeds{{{9600, B9600},
                                                 {19200, B19200},
                                                 {38400, B38400},
                                                 {57600, B57600},
                                                 {115200, B115200},
                                                 {230400, B230400},
                                                 {460800, B460800},
                                                 {921600, B921600},
                                                 {1500000, B1500000}}};
  const auto* const found = std::find_if(kSpeeds.begin(), kSpeeds.end(),
                                         [baud](const Speed& s) { return s.baud == baud; });
  return found == kSpeeds.end() ? std::nullopt : std::optional(found->speed);
}

bool set_up(int fd, speed_t speed) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) {
    return false;
  }
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
  settings.c_cc[VMIN] = 1;  // reading without available data gives EAGAIN, not end of file
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  return tcsetattr(fd, TCSANOW, &settings) == 0;
}

}  // namespace

bool is_baud_rate(int baud) { return speed_of(baud).has_value(); }

int open_serial_line(const std::string& device, int baud) {
  const int fd = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd >= 0 && !set_up(fd, speed_of(baud).value())) {
    const int why = errno;
    close(fd);
    errno = why;
    return -1;
  }
  return fd;
}

}  // namespace vantage
