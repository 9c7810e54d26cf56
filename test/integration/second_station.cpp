#include "test/integration/second_station.hpp"

#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/quadrotor/dialect.hpp"
#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/frame.hpp"
#include "wire/mavlink/parameter.hpp"

namespace vantage::test {
namespace {

namespace mavlink = wire::mavlink;

constexpr std::uint8_t kOwnSystem = 252;
constexpr std::uint8_t kOwnComponent = 190;  // MAV_COMP_ID_MISSIONPLANNER
constexpr float kCustomMode = 1.0F;          // MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
constexpr float kArdupilotBrake = 17.0F;     // ArduCopter's mode BRAKE
constexpr float kPx4Position = 3.0F;         // PX4's main mode POSCTL
constexpr double kPx4Joystick = 1.0;         // COM_RC_IN_MODE: joystick input from a station
constexpr double kPx4NoSticks = 4.0;         // COM_RC_IN_MODE: no joystick input
constexpr std::int16_t kMiddle = 500;        // neutral throttle of MANUAL_CONTROL, range 0 to 1000
constexpr double kArdupilotCapacity_mAh = 5600.0;  // the value that `vantage up` sets
constexpr double kPx4Drain_s = 900.0;

bool is_px4(models::AutopilotDialect dialect) { return dialect == models::AutopilotDialect::kPx4; }

}  // namespace

SecondStation::SecondStation(models::AutopilotDialect dialect, int instance, int system_id)
    : dialect_(dialect),
      system_id_(static_cast<std::uint8_t>(system_id)),
      socket_(::socket(AF_INET, is_px4(dialect) ? SOCK_DGRAM : SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(
      static_cast<std::uint16_t>(is_px4(dialect) ? 18'570 + instance : 5'762 + 10 * instance));
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

SecondStation::~SecondStation() {
  if (socket_ >= 0) {
    ::close(socket_);
  }
}

template <class Message>
bool SecondStation::send(const Message& message) {
  std::vector<std::uint8_t> bytes;
  mavlink::append_bytes(mavlink::pack(message, {kOwnSystem, kOwnComponent, sequence_++}), bytes);
  std::vector<std::uint8_t> unread(65'536);  // discarded: the receive buffer must not fill
  while (::recv(socket_, unread.data(), unread.size(), MSG_DONTWAIT) > 0) {
  }
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
         static_cast<ssize_t>(bytes.size());
}

bool SecondStation::set(const char* name, double value, std::uint8_t type) {
  mavlink::ParamSet message;
  message.target_system = system_id_;
  message.target_component = mavlink::kComponentAutopilot;
  message.param_id = mavlink::parameter_id(name);
  message.param_type = type;
  message.param_value = mavlink::encode_parameter(
      value, type,
      is_px4(dialect_) ? mavlink::ParameterEncoding::kBytewise : mavlink::ParameterEncoding::kCast);
  return send(message);
}

bool SecondStation::take_over() {
  return is_px4(dialect_)
             ? set("COM_RC_IN_MODE", kPx4Joystick, mavlink::parameter_type::kInt32) && keep()
             : order_mode(kArdupilotBrake);
}

bool SecondStation::keep() {
  if (!is_px4(dialect_)) {
    return true;
  }
  mavlink::ManualControl sticks;
  sticks.target = system_id_;
  sticks.z = kMiddle;
  return send(sticks) && order_mode(kPx4Position);
}

bool SecondStation::order_mode(float custom_mode) {
  mavlink::CommandLong order;
  order.command = mavlink::command::kSetMode;
  order.target_system = system_id_;
  order.target_component = mavlink::kComponentAutopilot;
  order.param1 = kCustomMode;
  order.param2 = custom_mode;
  return send(order);
}

bool SecondStation::give_back() {
  mavlink::CommandLong order = drivers::follow_mode_command(dialect_);
  order.target_system = system_id_;
  order.target_component = mavlink::kComponentAutopilot;
  return send(order) && (!is_px4(dialect_) ||
                         set("COM_RC_IN_MODE", kPx4NoSticks, mavlink::parameter_type::kInt32));
}

bool SecondStation::empty_battery() {
  return is_px4(dialect_) ? set("SIM_BAT_DRAIN", 30.0, mavlink::parameter_type::kFloat)
                          : set("BATT_CAPACITY", 1.0, mavlink::parameter_type::kInt32);
}

bool SecondStation::fill_battery() {
  return is_px4(dialect_)
             ? set("SIM_BAT_DRAIN", kPx4Drain_s, mavlink::parameter_type::kFloat)
             : set("BATT_CAPACITY", kArdupilotCapacity_mAh, mavlink::parameter_type::kInt32);
}

bool SecondStation::stop_motor() {
  return !is_px4(dialect_) && set("SIM_ENGINE_MUL", 0.0, mavlink::parameter_type::kFloat);
}

}  // namespace vantage::test
