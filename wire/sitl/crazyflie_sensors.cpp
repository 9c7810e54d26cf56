#include "wire/sitl/crazyflie_sensors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace vantage::wire::sitl {
namespace {

constexpr std::uint8_t kHeader = 0xE0;  // port 14, channel 0
constexpr std::uint8_t kLinkBits = 0x0C;
constexpr std::uint8_t kInertial = 0;
constexpr std::uint8_t kMagnetometer = 1;
constexpr std::uint8_t kBarometer = 2;
constexpr std::uint8_t kCalibrated = 1;

constexpr double kGravityMps2 = 9.81;
constexpr double kPerG = 65'536.0 / 32.0;
constexpr double kPerDegps = 65'536.0 / 4'000.0;
constexpr double kPerGauss = 666.7;

/// Writer of little-endian numbers after the header and the kind of the sensor.
template <std::size_t size>
class Packet {
 public:
  explicit Packet(std::uint8_t kind) : bytes_{kHeader, kind} {}
  void i16(double value) {
    constexpr double kMax = std::numeric_limits<std::int16_t>::max();
    append(static_cast<std::uint16_t>(
               static_cast<std::int16_t>(std::lround(std::clamp(value, -kMax - 1.0, kMax)))),
           2);
  }
  void f32(double value) { append(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4); }
  void vector(const Eigen::Vector3d& value) {
    i16(value.x());
    i16(value.y());
    i16(value.z());
  }
  [[nodiscard]] const std::array<std::uint8_t, size>& bytes() const { return bytes_; }

 private:
  void append(std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) {
      bytes_[next_++] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }
  std::array<std::uint8_t, size> bytes_;
  std::size_t next_ = 2;
};

}  // namespace

bool is_simulator_packet(std::span<const std::uint8_t> packet) {
  return !packet.empty() && (packet[0] & 0xF0U) == (kHeader & 0xF0U);
}

std::array<std::uint8_t, 14> format_inertial(const Eigen::Vector3d& specific_force_body_mps2,
                                             const Eigen::Vector3d& gyro_body_radps) {
  Packet<14> out(kInertial);
  out.vector(specific_force_body_mps2 * (kPerG / kGravityMps2));
  out.vector(gyro_body_radps * (kPerDegps * 180.0 / std::numbers::pi));
  return out.bytes();
}

std::array<std::uint8_t, 8> format_magnetometer(const Eigen::Vector3d& field_body_gauss) {
  Packet<8> out(kMagnetometer);
  out.vector(field_body_gauss * kPerGauss);
  return out.bytes();
}

std::array<std::uint8_t, 14> format_barometer(double pressure_hpa, double temperature_c,
                                              double altitude_m) {
  Packet<14> out(kBarometer);
  out.f32(pressure_hpa);
  out.f32(temperature_c);
  out.f32(altitude_m);
  return out.bytes();
}

std::optional<MotorDuties> parse_motor_duties(std::span<const std::uint8_t> packet) {
  if (packet.size() != 9 || (packet[0] & ~kLinkBits) != kHeader) {
    return std::nullopt;
  }
  const auto duty = [&](std::size_t motor) {
    const std::uint8_t* at = &packet[1 + 2 * motor];
    return (at[0] + 256.0 * at[1]) / std::numeric_limits<std::uint16_t>::max();
  };
  return MotorDuties{duty(0), duty(1), duty(2), duty(3)};
}

bool is_gyro_calibrated(std::span<const std::uint8_t> packet) {
  return packet.size() == 2 && (packet[0] & ~kLinkBits) == kHeader && packet[1] == kCalibrated;
}

}  // namespace vantage::wire::sitl
