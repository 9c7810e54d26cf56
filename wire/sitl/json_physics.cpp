#include "wire/sitl/json_physics.hpp"

#include <cstring>

#include <fmt/format.h>

namespace vantage::wire::sitl {
namespace {

constexpr std::uint16_t kMagic16 = 18458;
constexpr std::uint16_t kMagic32 = 29569;
constexpr std::size_t kHead = 8;
constexpr std::size_t kBytes16 = kHead + 2 * 16;
constexpr std::size_t kBytes32 = kHead + 2 * 32;

// Returns the value at `offset`. The firmware sends structs from memory; the firmware and this code
// run only on little-endian machines.
template <class T>
T at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{:.9g},{:.9g},{:.9g}]", v.x(), v.y(), v.z());
}

}  // namespace

std::optional<ServoOutputs> parse_servo_outputs(std::span<const std::uint8_t> datagram) {
  if (datagram.size() != kBytes16 && datagram.size() != kBytes32) {
    return std::nullopt;
  }
  const auto magic = at<std::uint16_t>(datagram, 0);
  if (magic != (datagram.size() == kBytes16 ? kMagic16 : kMagic32)) {
    return std::nullopt;
  }
  ServoOutputs out;
  out.frame_rate_hz = at<std::uint16_t>(datagram, 2);
  out.frame_count = at<std::uint32_t>(datagram, 4);
  for (std::size_t i = 0; i < out.pulse_us.size(); ++i) {
    out.pulse_us[i] = at<std::uint16_t>(datagram, kHead + 2 * i);
  }
  return out;
}

std::array<std::uint8_t, 40> format_servo_outputs(const ServoOutputs& outputs) {
  std::array<std::uint8_t, kBytes16> bytes{};
  std::memcpy(bytes.data(), &kMagic16, 2);
  std::memcpy(bytes.data() + 2, &outputs.frame_rate_hz, 2);
  std::memcpy(bytes.data() + 4, &outputs.frame_count, 4);
  std::memcpy(bytes.data() + kHead, outputs.pulse_us.data(), 2 * outputs.pulse_us.size());
  return bytes;
}

std::string format_json_sensors(const JsonSensors& s) {
  const Quaternion& q = s.local_from_body;
  return fmt::format(
      "\n{{\"timestamp\":{:.6f},\"imu\":{{\"gyro\":{},\"accel_body\":{}}},\"position\":{},"
      "\"velocity\":{},\"quaternion\":[{:.9g},{:.9g},{:.9g},{:.9g}],\"no_time_sync\":1}}\n",
      s.time_s, list(s.gyro_body_radps), list(s.specific_force_body_mps2), list(s.position_local_m),
      list(s.velocity_local_mps), q.w(), q.x(), q.y(), q.z());
}

}  // namespace vantage::wire::sitl
