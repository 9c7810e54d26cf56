#include "sim/firmware/crazyflie_link.hpp"

#include <cerrno>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/axes.hpp"
#include "core/check.hpp"
#include "wire/sitl/crazyflie_sensors.hpp"

namespace vantage::sim {
namespace {

namespace sitl = wire::sitl;

// Magnetometer and barometer are sampled at 50 Hz each, in turn.
constexpr std::int64_t kFieldEvery = 20;
constexpr std::int64_t kPressureTurn = 10;

constexpr std::int64_t kSamplePeriodMinNs = 500'000;
constexpr std::int64_t kClientPeriodNs = 1'000'000;

int open_crazyflie_port(int port) {
  const sockaddr_in address = address_of(INADDR_LOOPBACK, port);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0 || bind(fd, as_sockaddr(address), sizeof address) != 0) {
    const std::string why = std::system_category().message(errno);
    if (fd >= 0) {
      close(fd);
    }
    throw StartupError(fmt::format("crazyflie firmware: UDP port {} on this host: {}", port, why));
  }
  return fd;
}

}  // namespace

MultirotorParameters crazyflie_body() {
  // Thrust of one motor as the firmware assumes it: N = 0.09149 d² + 0.06767 d, with duty cycle d.
  constexpr double kQuadraticN = 0.09149;
  constexpr double kLinearN = 0.06767;
  constexpr double kArmM = 0.046;
  MultirotorParameters out;
  out.mass_kg = 0.027;
  out.arm_x_m = kArmM * std::sqrt(0.5);
  out.arm_y_m = kArmM * std::sqrt(0.5);
  out.inertia_kgm2 = {1.657e-5, 1.666e-5, 2.926e-5};
  out.motor_thrust_max_n = kQuadraticN + kLinearN;
  out.motor_lag_s = 0.020;
  out.thrust_expo = kQuadraticN / (kQuadraticN + kLinearN);
  out.torque_per_thrust_m = 0.00596;
  out.drag_per_s = 0.3;
  out.spin_drag_nms = 5e-6;
  out.foot_m = 0.03;
  out.foot_stiffness_npm = 70.0;
  out.foot_damping_nspm = 1.0;
  out.battery_endurance_s = 420.0;
  out.battery_full_v = 4.2;
  out.battery_empty_v = 3.2;
  out.battery_sag_v = 0.2;
  out.battery_hover_a = 2.0;
  return out;
}

SensorNoise crazyflie_noise() {
  SensorNoise out;
  out.gyro_sigma_radps = 0.00175;        // 0.1 °/s
  out.accelerometer_sigma_mps2 = 0.049;  // 0.005 times standard gravity
  return out;
}

CrazyflieLink::Ports CrazyflieLink::ports_of(int instance) {
  return {sitl::kCrazyflieFirmwarePort + instance, sitl::kCrazyflieClientPort + instance};
}

CrazyflieLink::CrazyflieLink(const Ports& ports, Clock clock)
    : firmware_fd_(open_crazyflie_port(ports.firmware)), clock_(std::move(clock)) {
  try {
    client_fd_ = open_crazyflie_port(ports.client);
  } catch (const StartupError&) {
    close(firmware_fd_);
    throw;
  }
}

CrazyflieLink::~CrazyflieLink() {
  close(firmware_fd_);
  close(client_fd_);
}

/// Returns the next datagram of `fd` that has an admissible length; nullopt if none waits.
std::optional<CrazyflieLink::Bytes> CrazyflieLink::read(int fd, sockaddr_in& from) {
  while (true) {
    socklen_t length = sizeof from;
    const ssize_t got = recvfrom(fd, buffer_.data(), buffer_.size(), 0,
                                 reinterpret_cast<sockaddr*>(&from), &length);
    if (got < 0) {
      // A firmware or client that has ended is reported once as ECONNREFUSED on some systems.
      if (errno == ECONNREFUSED || errno == EINTR) {
        continue;
      }
      return std::nullopt;
    }
    const auto size = static_cast<std::size_t>(got);
    if (size >= 1 && size <= sitl::kCrazyfliePacketMax) {
      return Bytes(buffer_.data(), size);
    }
    ++counts_.bad_length;
  }
}

bool CrazyflieLink::write(int fd, const std::optional<sockaddr_in>& to, Bytes packet) {
  if (!to) {
    ++counts_.no_peer;
    return false;
  }
  if (sendto(fd, packet.data(), packet.size(), MSG_NOSIGNAL, as_sockaddr(*to), sizeof *to) !=
      static_cast<ssize_t>(packet.size())) {
    ++counts_.unsent;
    return false;
  }
  return true;
}

void CrazyflieLink::relay_client() {
  sockaddr_in from{};
  while (clock_() - relayed_ns_ >= kClientPeriodNs) {
    const auto packet = read(client_fd_, from);
    if (!packet) {
      return;
    }
    client_ = from;
    if (sitl::is_simulator_packet(*packet)) {
      ++counts_.forged;
    } else if (write(firmware_fd_, firmware_, *packet)) {
      ++counts_.to_firmware;
      relayed_ns_ = clock_();
    }
  }
}

void CrazyflieLink::relay_firmware(std::optional<MotorCommand>& newest) {
  sockaddr_in from{};
  while (const auto packet = read(firmware_fd_, from)) {
    if (packet->size() == 1 && (*packet)[0] == sitl::kCrazyflieHello) {
      firmware_ = from;
      counts_.hellos += write(firmware_fd_, firmware_, *packet) ? 1 : 0;
    } else if (const auto duties = sitl::parse_motor_duties(*packet)) {
      newest = MotorCommand{
          {duties->front_right, duties->rear_left, duties->front_left, duties->rear_right}};
    } else if (!sitl::is_simulator_packet(*packet) && write(client_fd_, client_, *packet)) {
      ++counts_.to_client;
    }
  }
}

bool CrazyflieLink::send(const FirmwareSensors& sensors) {
  if (!firmware_) {
    return false;
  }
  if (clock_() - sampled_ns_ < kSamplePeriodMinNs) {
    ++counts_.crowded;
    return false;
  }
  sampled_ns_ = clock_();
  const auto inertial = sitl::format_inertial(convert_axes(sensors.specific_force_body_mps2),
                                              convert_axes(sensors.gyro_body_radps));
  const bool is_sent = write(firmware_fd_, firmware_, inertial);
  const std::int64_t turn = samples_++ % kFieldEvery;
  if (turn == 0) {
    write(firmware_fd_, firmware_,
          sitl::format_magnetometer(convert_axes(sensors.magnetic_field_body_gauss)));
  } else if (turn == kPressureTurn) {
    write(firmware_fd_, firmware_,
          sitl::format_barometer(sensors.pressure_hpa, sensors.temperature_c,
                                 sensors.pressure_altitude_m));
  }
  return is_sent;
}

std::optional<MotorCommand> CrazyflieLink::receive(Duration timeout) {
  if (timeout > Duration{0}) {
    std::array<pollfd, 2> polled{{{firmware_fd_, POLLIN, 0}, {client_fd_, POLLIN, 0}}};
    const timespec limit{timeout.count() / 1'000'000, timeout.count() % 1'000'000 * 1'000};
    ppoll(polled.data(), polled.size(), &limit, nullptr);
  }
  std::optional<MotorCommand> newest;
  relay_client();
  relay_firmware(newest);
  return newest;
}

}  // namespace vantage::sim
