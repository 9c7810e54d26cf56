#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"

// ArduPilot's "JSON" physics back end, which connects firmware compiled for a computer to an
// external simulator. Datagrams carry motor outputs to the simulator and sensor values to the
// firmware. Both run in lockstep: the firmware's clock waits for the sensor values.
// Source: ArduPilot, libraries/SITL/SIM_JSON and examples/JSON/readme.

namespace vantage::wire::sitl {

/// port of instance 0; each further instance adds 10
inline constexpr std::uint16_t kJsonPort = 9002;

/// Content of a datagram from the firmware.
struct ServoOutputs {
  std::uint16_t frame_rate_hz = 0;  ///< Hz; requested rate of answers
  std::uint32_t frame_count = 0;
  std::array<std::uint16_t, 16> pulse_us{};  ///< µs; 1000 … 2000; 0: no output
};

/// Parses the firmware's datagram; returns nullopt for any other datagram. Datagrams with 32
/// outputs are accepted; only the first 16 are used.
std::optional<ServoOutputs> parse_servo_outputs(std::span<const std::uint8_t> datagram);
/// Encodes the firmware's datagram, to emulate the firmware in tests.
std::array<std::uint8_t, 40> format_servo_outputs(const ServoOutputs& outputs);

/// Sensor values for the firmware. Local frame NED, body FRD.
struct JsonSensors {
  double time_s = 0.0;  ///< s since the start of the simulation; must increase
  Eigen::Vector3d gyro_body_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_body_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_local_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_local_mps = Eigen::Vector3d::Zero();
  Quaternion local_from_body = Quaternion::Identity();
};

/// Encodes one datagram: a line of JSON between line feeds. The line has no blanks, because the
/// firmware's parser does not expect blanks. The key "no_time_sync" lets the simulator choose how
/// fast simulated time passes.
std::string format_json_sensors(const JsonSensors& sensors);

}  // namespace vantage::wire::sitl
