#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include "core/check.hpp"
#include "drivers/vehicle/port.hpp"

namespace vantage::drivers {
namespace {

// Two thirds of a second at 57600 baud: what waits longer than that is stale.
constexpr std::size_t kWaitingMax = 4096;
constexpr Duration kRetryFirst = std::chrono::milliseconds(250);
constexpr Duration kRetryMax = std::chrono::seconds(4);

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

class SerialPort : public Port {
 public:
  SerialPort(std::string device, speed_t speed) : device_(std::move(device)), speed_(speed) {}
  ~SerialPort() override { hang_up(); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  SerialPort(SerialPort&&) = delete;
  SerialPort& operator=(SerialPort&&) = delete;

  [[nodiscard]] bool is_datagram() const override { return false; }

  std::size_t read(std::span<std::uint8_t> buffer, Time now) override {
    if (!is_open(now)) {
      return 0;
    }
    const ssize_t got = ::read(fd_, buffer.data(), buffer.size());
    if (got < 0 && errno != EAGAIN && errno != EINTR) {
      lose();
    }
    return got > 0 ? static_cast<std::size_t>(got) : 0;
  }

  void write(std::span<const std::uint8_t> message, Time now) override {
    if (!is_open(now)) {
      ++dropped_;
      return;
    }
    if (waiting_.size() + message.size() > kWaitingMax) {
      ++dropped_;
    } else {
      waiting_.insert(waiting_.end(), message.begin(), message.end());
    }
    const ssize_t sent = ::write(fd_, waiting_.data(), waiting_.size());
    if (sent > 0) {
      waiting_.erase(waiting_.begin(), waiting_.begin() + sent);
    } else if (sent < 0 && errno != EAGAIN && errno != EINTR) {
      lose();
    }
  }

  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    std::vector<models::NamedCount> out;
    if (dropped_ > 0) {
      out.push_back({"port.messages_dropped", dropped_});
    }
    if (losses_ > 0) {
      out.push_back({"port.losses", losses_});
    }
    return out;
  }

 private:
  /// Opens the device when it is time to try again.
  bool is_open(Time now) {
    if (fd_ >= 0) {
      return true;
    }
    if (now < next_try_) {
      return false;
    }
    next_try_ = now + retry_;
    retry_ = std::min(2 * retry_, kRetryMax);
    fd_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0 || !set_up()) {
      hang_up();
      return false;
    }
    retry_ = kRetryFirst;
    return true;
  }
  bool set_up() const {
    termios settings{};
    if (tcgetattr(fd_, &settings) != 0) {
      return false;
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
    settings.c_cc[VMIN] = 1;  // an empty line is EAGAIN, not an end of file
    settings.c_cc[VTIME] = 0;
    cfsetispeed(&settings, speed_);
    cfsetospeed(&settings, speed_);
    return tcsetattr(fd_, TCSANOW, &settings) == 0;
  }
  void lose() {
    ++losses_;
    hang_up();
  }
  /// What waited is forgotten: a command must not come out when the line is back.
  void hang_up() {
    if (fd_ >= 0) {
      close(fd_);
    }
    fd_ = -1;
    waiting_.clear();
  }

  std::string device_;
  speed_t speed_;
  int fd_ = -1;
  Time next_try_{};
  Duration retry_ = kRetryFirst;
  std::vector<std::uint8_t> waiting_;
  std::int64_t dropped_ = 0;
  std::int64_t losses_ = 0;
};

}  // namespace

std::unique_ptr<Port> open_serial_port(const std::string& device, int baud) {
  const auto speed = speed_of(baud);
  if (!speed) {
    throw StartupError("serial:" + device + ": " + std::to_string(baud) + " is not a baud rate");
  }
  return std::make_unique<SerialPort>(device, *speed);
}

}  // namespace vantage::drivers
