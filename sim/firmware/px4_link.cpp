#include "sim/firmware/px4_link.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "core/serial_line.hpp"
#include "wire/mavlink/constants.hpp"

namespace vantage::sim {
namespace {

// Bits of fields_updated in HIL_SENSOR.
constexpr std::uint32_t kInertialFields = 0x3F;
constexpr std::uint32_t kMagneticFields = 0x1C0;
constexpr std::uint32_t kBarometerFields = 0x1A00;  // pressure, pressure altitude, temperature
// Magnetometer and barometer are sampled less often than the inertial unit: at 50 Hz each,
// alternately.
constexpr std::int64_t kSlowEvery = 5;
constexpr std::int64_t kBarometerTurn = 2;

constexpr std::int64_t kHeartbeatEvery = 250;
constexpr std::uint8_t kOwnSystemId = 200;
constexpr int kBaud = 921'600;
constexpr std::int64_t kReopenNs = 500'000'000;

int listen_at(int port) {
  const sockaddr_in address = address_of(INADDR_LOOPBACK, port);
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (fd < 0 || bind(fd, as_sockaddr(address), sizeof address) != 0 || listen(fd, 4) != 0) {
    const std::string why = std::system_category().message(errno);
    if (fd >= 0) {
      close(fd);
    }
    throw StartupError(fmt::format("firmware: TCP port {} on this host: {}", port, why));
  }
  return fd;
}

int accept_newest(int listener) {
  int newest = -1;
  for (int fd = 0; (fd = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)) >= 0;) {
    if (newest >= 0) {
      close(newest);
    }
    newest = fd;
    const int yes = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  }
  return newest;
}

float narrow(double value) { return static_cast<float>(value); }

wire::mavlink::HilSensor hil_sensor_of(const FirmwareSensors& sensors, std::int64_t sample) {
  wire::mavlink::HilSensor out;
  out.time_usec = static_cast<std::uint64_t>(sensors.since_start.count());
  out.xacc = narrow(sensors.specific_force_body_mps2.x());
  out.yacc = narrow(sensors.specific_force_body_mps2.y());
  out.zacc = narrow(sensors.specific_force_body_mps2.z());
  out.xgyro = narrow(sensors.gyro_body_radps.x());
  out.ygyro = narrow(sensors.gyro_body_radps.y());
  out.zgyro = narrow(sensors.gyro_body_radps.z());
  out.xmag = narrow(sensors.magnetic_field_body_gauss.x());
  out.ymag = narrow(sensors.magnetic_field_body_gauss.y());
  out.zmag = narrow(sensors.magnetic_field_body_gauss.z());
  out.abs_pressure = narrow(sensors.pressure_hpa);
  out.pressure_alt = narrow(sensors.pressure_altitude_m);
  out.temperature = narrow(sensors.temperature_c);
  out.fields_updated = kInertialFields;
  if (sample % kSlowEvery == 0) {
    out.fields_updated |= kMagneticFields;
  } else if (sample % kSlowEvery == kBarometerTurn) {
    out.fields_updated |= kBarometerFields;
  }
  return out;
}

}  // namespace

std::unique_ptr<Px4Link> Px4Link::listening(int instance) {
  const int listener = listen_at(kPort + instance);
  return std::unique_ptr<Px4Link>(
      new Px4Link(listener, true, [listener] { return accept_newest(listener); }));
}

std::unique_ptr<Px4Link> Px4Link::on_serial_line(const std::string& line) {
  std::string device = line;
  int baud = kBaud;
  if (const std::size_t colon = line.rfind(':'); colon != std::string::npos) {
    device = line.substr(0, colon);
    const std::string text = line.substr(colon + 1);
    const auto [end, why] = std::from_chars(text.data(), text.data() + text.size(), baud);
    if (why != std::errc{} || end != text.data() + text.size() || !is_baud_rate(baud)) {
      throw StartupError(
          fmt::format("firmware: serial line {}: {} is not a baud rate", line, text));
    }
  }
  const auto open = [device, baud, next_try_ns = std::int64_t{0}]() mutable {
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns < next_try_ns) {
      return -1;
    }
    next_try_ns = now_ns + kReopenNs;
    return open_serial_line(device, baud);
  };
  return std::unique_ptr<Px4Link>(new Px4Link(-1, false, open));
}

Px4Link::Px4Link(int listener, bool is_lockstep, std::function<int()> open)
    : listener_(listener), is_lockstep_(is_lockstep), open_(std::move(open)) {}

Px4Link::~Px4Link() {
  hang_up();
  if (listener_ >= 0) {
    close(listener_);
  }
}

void Px4Link::hang_up() {
  if (line_ >= 0) {
    close(line_);
  }
  line_ = -1;
  waiting_.clear();
  newest_.reset();
  parser_ = {};
}

void Px4Link::connect() {
  if (line_ >= 0 && listener_ < 0) {
    return;
  }
  if (const int fresh = open_(); fresh >= 0) {
    hang_up();
    line_ = fresh;
  }
}

bool Px4Link::write_some() {
  const ssize_t sent = listener_ >= 0
                           ? ::send(line_, waiting_.data(), waiting_.size(), MSG_NOSIGNAL)
                           : ::write(line_, waiting_.data(), waiting_.size());
  if (sent < 0 && errno != EAGAIN && errno != EINTR) {
    hang_up();
  }
  if (sent <= 0) {
    return false;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + sent);
  return true;
}

template <class Message>
bool Px4Link::write(const Message& message) {
  // Sends the rest of a partly sent frame first; otherwise the next frame would be lost as well.
  if (!waiting_.empty() && (!write_some() || !waiting_.empty())) {
    ++counts_.unsent;
    return false;
  }
  wire::mavlink::append_bytes(wire::mavlink::pack(message, {kOwnSystemId, 1, sequence_++}),
                              waiting_);
  if (!write_some()) {
    waiting_.clear();
    ++counts_.unsent;
    return false;
  }
  return true;
}

bool Px4Link::send(const FirmwareSensors& sensors) {
  connect();
  if (line_ < 0) {
    return false;
  }
  if (samples_ % kHeartbeatEvery == 0) {  // a board starts its USB line when it receives data
    write(wire::mavlink::heartbeat_of(wire::mavlink::type::kOnboardController));
  }
  const wire::mavlink::HilSensor words = hil_sensor_of(sensors, samples_++);
  last_sent_usec_ = words.time_usec;
  newest_.reset();
  return line_ >= 0 && write(words);
}

void Px4Link::handle(const wire::mavlink::Frame& frame) {
  const auto controls = wire::mavlink::unpack<wire::mavlink::HilActuatorControls>(frame);
  if (!controls) {
    return;
  }
  if (is_lockstep_ && controls->time_usec < last_sent_usec_) {
    ++counts_.stale;
    return;
  }
  newest_.emplace();
  for (std::size_t i = 0; i < kMotors && (controls->mode & wire::mavlink::kArmedFlag) != 0; ++i) {
    const double throttle = controls->controls[i];
    newest_->throttles[i] = throttle > 0.0 ? std::min(throttle, 1.0) : 0.0;  // NaN: motor off
  }
}

void Px4Link::read() {
  while (line_ >= 0) {
    const ssize_t got = ::read(line_, buffer_.data(), buffer_.size());
    if (got > 0) {
      parser_.feed({buffer_.data(), static_cast<std::size_t>(got)},
                   [this](const wire::mavlink::Frame& frame) { handle(frame); });
    } else if (got < 0 && errno == EAGAIN) {
      return;
    } else if (got == 0 || errno != EINTR) {
      hang_up();
    }
  }
}

std::optional<MotorCommand> Px4Link::receive(Duration timeout) {
  connect();
  read();
  const std::int64_t end_ns = monotonic_ns() + timeout.count() * 1'000;
  while (!newest_ && line_ >= 0) {
    const std::int64_t left_ns = end_ns - monotonic_ns();
    if (left_ns <= 0) {
      return std::nullopt;
    }
    pollfd polled{line_, POLLIN, 0};
    const timespec limit{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    ppoll(&polled, 1, &limit, nullptr);
    read();
  }
  return std::exchange(newest_, std::nullopt);
}

}  // namespace vantage::sim
