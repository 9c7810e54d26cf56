#include <algorithm>
#include <cerrno>
#include <deque>

#include <unistd.h>

#include "core/check.hpp"
#include "core/serial_line.hpp"
#include "drivers/vehicle/port.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

// bytes; about 0.2 s of data at the slowest rate; older messages are outdated.
constexpr std::size_t kWaitingMax = 4096;
// Signed poses (258 bytes) and set-points (78 bytes), each 50 times per second, need 17 kB/s; a
// byte requires ten bits on a serial line.
constexpr int kBaudMin = 230'400;
constexpr Duration kRetryFirst = std::chrono::milliseconds(250);
constexpr Duration kRetryMax = std::chrono::seconds(4);

class SerialPort : public Port {
 public:
  SerialPort(std::string device, int baud) : device_(std::move(device)), baud_(baud) {}
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
    if (!message.empty()) {
      waiting_.insert(waiting_.end(), message.begin(), message.end());
      sizes_.push_back(message.size());
    }
    // Drops the oldest message of which no byte was sent: newer messages are more important, and
    // may be stop commands.
    while (waiting_.size() > kWaitingMax && sizes_.size() > 2) {
      const auto second = waiting_.begin() + static_cast<std::ptrdiff_t>(sizes_[0]);
      waiting_.erase(second, second + static_cast<std::ptrdiff_t>(sizes_[1]));
      sizes_.erase(sizes_.begin() + 1);
      ++dropped_;
    }
    send();
  }

  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    return models::nonzero({{"port.messages_dropped", dropped_}, {"port.losses", losses_}});
  }

 private:
  /// Returns true if the device is open; tries to open it if a retry is due.
  bool is_open(Time now) {
    if (fd_ >= 0) {
      return true;
    }
    if (now < next_try_) {
      return false;
    }
    next_try_ = now + retry_;
    retry_ = std::min(2 * retry_, kRetryMax);
    fd_ = open_serial_line(device_, baud_);
    if (fd_ < 0) {
      return false;
    }
    retry_ = kRetryFirst;
    return true;
  }
  void send() {
    const ssize_t sent = ::write(fd_, waiting_.data(), waiting_.size());
    if (sent < 0 && errno != EAGAIN && errno != EINTR) {
      lose();
    }
    if (sent <= 0) {
      return;
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + sent);
    auto gone = static_cast<std::size_t>(sent);
    while (!sizes_.empty() && gone >= sizes_.front()) {
      gone -= sizes_.front();
      sizes_.pop_front();
    }
    if (!sizes_.empty()) {
      sizes_.front() -= gone;
    }
  }
  void lose() {
    ++losses_;
    hang_up();
  }
  /// Closes the device and drops waiting messages: a command must not be sent after the line has
  /// recovered.
  void hang_up() {
    if (fd_ >= 0) {
      close(fd_);
    }
    fd_ = -1;
    waiting_.clear();
    sizes_.clear();
  }

  std::string device_;
  int baud_;
  int fd_ = -1;
  Time next_try_{};
  Duration retry_ = kRetryFirst;
  /// bytes to send; begins with the rest of a partly sent message
  std::vector<std::uint8_t> waiting_;
  std::deque<std::size_t> sizes_;  ///< size of each message in waiting_, bytes
  std::int64_t dropped_ = 0;
  std::int64_t losses_ = 0;
};

}  // namespace

std::unique_ptr<Port> open_serial_port(const std::string& device, int baud) {
  if (!is_baud_rate(baud)) {
    throw StartupError("serial:" + device + ": " + std::to_string(baud) + " is not a baud rate");
  }
  if (baud < kBaudMin) {
    throw StartupError(
        "serial:" + device + ": " + std::to_string(baud) +
        " baud is too slow: poses and set-points take 17 kB/s, which needs " +
        std::to_string(kBaudMin) +
        " or more (over USB any rate works; a telemetry radio is unsuitable for flight)");
  }
  return std::make_unique<SerialPort>(device, baud);
}

}  // namespace vantage::drivers
