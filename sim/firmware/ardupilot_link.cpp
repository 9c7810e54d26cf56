#include "sim/firmware/ardupilot_link.hpp"

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "wire/sitl/json_physics.hpp"

namespace vantage::sim {
namespace {

namespace sitl = wire::sitl;

constexpr double kPulseOffUs = 1000.0;
constexpr double kPulseRangeUs = 1000.0;

}  // namespace

ArdupilotLink::ArdupilotLink(int instance) {
  const int port = sitl::kJsonPort + 10 * instance;
  const sockaddr_in address = address_of(INADDR_LOOPBACK, port);
  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ < 0 || bind(fd_, as_sockaddr(address), sizeof address) != 0) {
    const std::string why = std::system_category().message(errno);
    if (fd_ >= 0) {
      close(fd_);
    }
    throw StartupError(
        fmt::format("firmware instance {}: UDP port {} on this host: {}", instance, port, why));
  }
}

ArdupilotLink::~ArdupilotLink() { close(fd_); }

bool ArdupilotLink::send(const FirmwareSensors& sensors) {
  if (!has_unanswered_) {
    return false;
  }
  sitl::JsonSensors out;
  out.time_s = to_seconds(sensors.since_start);
  out.gyro_body_radps = sensors.gyro_body_radps;
  out.specific_force_body_mps2 = sensors.specific_force_body_mps2;
  out.position_local_m = sensors.position_local_m;
  out.velocity_local_mps = sensors.velocity_local_mps;
  out.local_from_body = sensors.local_from_body;
  const std::string text = sitl::format_json_sensors(out);
  has_unanswered_ = false;
  return sendto(fd_, text.data(), text.size(), MSG_NOSIGNAL, as_sockaddr(*firmware_),
                sizeof *firmware_) == static_cast<ssize_t>(text.size());
}

std::optional<MotorCommand> ArdupilotLink::receive(Duration timeout) {
  pollfd polled{fd_, POLLIN, 0};
  const timespec limit{timeout.count() / 1'000'000, timeout.count() % 1'000'000 * 1'000};
  if (ppoll(&polled, 1, &limit, nullptr) <= 0) {
    return std::nullopt;
  }
  // Keeps only the newest command: the firmware repeats its last command when it receives no
  // answer.
  std::optional<MotorCommand> newest;
  while (true) {
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t got = recvfrom(fd_, buffer_.data(), buffer_.size(), 0,
                                 reinterpret_cast<sockaddr*>(&from), &length);
    if (got < 0) {
      return newest;
    }
    const auto outputs = sitl::parse_servo_outputs({buffer_.data(), static_cast<std::size_t>(got)});
    if (outputs) {
      firmware_ = from;
      has_unanswered_ = true;
      newest.emplace();
      for (std::size_t i = 0; i < kMotors; ++i) {
        newest->throttles[i] =
            std::clamp((outputs->pulse_us[i] - kPulseOffUs) / kPulseRangeUs, 0.0, 1.0);
      }
    }
  }
}

}  // namespace vantage::sim
