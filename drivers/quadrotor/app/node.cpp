#include "drivers/quadrotor/app/node.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/check.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds(5);

std::string reason(int error) { return std::system_category().message(error); }

std::string key_file_of(const models::Scenario& scenario, const std::string& robot) {
  const models::RobotSpec* spec = scenario.find_robot(robot);
  return spec != nullptr && spec->autopilot ? spec->autopilot->key_file : "";
}

}  // namespace

std::optional<models::mavlink::SigningKey> load_key(const std::string& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    throw StartupError(file + ": cannot read the signing key: " + reason(errno));
  }
  struct stat status {};
  models::mavlink::SigningKey key{};
  const bool is_known = fstat(fd, &status) == 0;
  const ssize_t got = is_known ? read(fd, key.data(), key.size()) : -1;
  close(fd);
  if (got < 0) {
    throw StartupError(file + ": cannot read the signing key: " + reason(errno));
  }
  if (!S_ISREG(status.st_mode) || status.st_size != static_cast<off_t>(key.size()) ||
      got != static_cast<ssize_t>(key.size())) {
    throw StartupError(file + ": a signing key is a file of 32 bytes, this one has " +
                       std::to_string(status.st_size));
  }
  if (status.st_uid != geteuid()) {
    throw StartupError(file + ": the signing key belongs to another user; it must be ours alone");
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw StartupError(file + ": others may read or change the signing key; chmod 600 " + file);
  }
  return key;
}

QuadrotorNode::QuadrotorNode(bus::Bus& bus, const bus::Clock& clock,
                             const models::Scenario& scenario, const std::string& robot,
                             std::unique_ptr<Port> port)
    : VehicleNode("QUADROTOR_" + robot, kTickPeriod, bus, clock, scenario, robot, std::move(port),
                  load_key(key_file_of(scenario, robot))) {}

void QuadrotorNode::on_mocap(const models::MocapFrame& frame, Time now) {
  driver().on_mocap(frame, now);
  send_output(now);
}

void QuadrotorNode::on_command(const models::OperatorCommand& command, Time now) {
  driver().on_command(command, now);
  act(now);
}

void QuadrotorNode::receive(std::span<const std::uint8_t> bytes, Time now) {
  driver().receive(bytes, port().is_datagram(), now);
}

void QuadrotorNode::act(Time now) {
  driver().tick(now);
  send_output(now);
}

void QuadrotorNode::send_output(Time now) {
  for (const WireMessage& message : driver().take_output()) {
    port().write(message, now);
  }
}

}  // namespace vantage::drivers
