#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

// Link between Crazyflie firmware compiled for a computer and its simulator: datagrams of at most
// 31 bytes, one CRTP packet each. The firmware sends hello packets until the simulator answers with
// the same byte. Then sensor values go to the firmware, and motor commands to the simulator, on a
// separate CRTP port; the packets of a client use the same link.
// Source: firmware for Linux (crazyflie-firmware, branch sitl-release), sensors_sitl and
// power_distribution_sitl. That branch uses CRTP port 9, which is the supervisor's port in firmware
// since 2025; port 14 is used here instead.

namespace vantage::wire::sitl {

/// port of the simulator for firmware instance 0; each further instance adds 1
inline constexpr int kCrazyflieFirmwarePort = 19'950;
/// port of the simulator for a client of instance 0; each further instance adds 1
inline constexpr int kCrazyflieClientPort = 19'850;
/// only byte of the hello packet and of its answer
inline constexpr std::uint8_t kCrazyflieHello = 0xF3;
inline constexpr std::size_t kCrazyfliePacketMax = 31;

/// True for a packet between firmware and simulator, which no client sends or receives.
bool is_simulator_packet(std::span<const std::uint8_t> packet);

/// Encodes one sample of the inertial unit, body FLU: in units of 1/2048 g and 1/16.384 °/s,
/// saturated at ± 16 g and ± 2000 °/s.
std::array<std::uint8_t, 14> format_inertial(const Eigen::Vector3d& specific_force_body_mps2,
                                             const Eigen::Vector3d& gyro_body_radps);
/// Encodes one sample of the magnetometer, body FLU, in units of 1/666.7 gauss.
std::array<std::uint8_t, 8> format_magnetometer(const Eigen::Vector3d& field_body_gauss);
/// Encodes one sample of the barometer.
std::array<std::uint8_t, 14> format_barometer(double pressure_hpa, double temperature_c,
                                              double altitude_m);

/// Duty cycles of the motors, in [0, 1].
struct MotorDuties {
  double front_right = 0.0;  ///< motor M1
  double rear_right = 0.0;   ///< motor M2
  double rear_left = 0.0;    ///< motor M3
  double front_left = 0.0;   ///< motor M4
};
/// Parses a motor command; returns nullopt for any other packet.
std::optional<MotorDuties> parse_motor_duties(std::span<const std::uint8_t> packet);
/// True for the message which states that the gyroscope's bias is known; from then on the firmware
/// can fly.
bool is_gyro_calibrated(std::span<const std::uint8_t> packet);

}  // namespace vantage::wire::sitl
