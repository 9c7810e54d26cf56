#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/linear.hpp"

// ArduPilot's "JSON" physics back end: how its firmware, compiled for a computer, speaks with a
// simulator that is not its own. One datagram of motor outputs, one of sensors, in lockstep: the
// firmware's clock stands until the sensors come.
// Source: ArduPilot, libraries/SITL/SIM_JSON and examples/JSON/readme.

namespace vantage::wire::sitl {

inline constexpr std::uint16_t kJsonPort = 9002;  ///< + 10 for each instance

/// What the firmware sends.
struct ServoOutputs {
  std::uint16_t frame_rate_hz = 0;  ///< how often it would like to be answered
  std::uint32_t frame_count = 0;
  std::array<std::uint16_t, 16> pulse_us{};  ///< 1000 … 2000; 0: no output
};

/// nullopt for what is no such datagram. Those with 32 outputs are taken too; the first 16 count.
std::optional<ServoOutputs> parse_servo_outputs(std::span<const std::uint8_t> datagram);
/// For emulating the firmware in tests.
std::array<std::uint8_t, 40> format_servo_outputs(const ServoOutputs& outputs);

/// What the firmware is told. Local frame NED, body FRD.
struct JsonSensors {
  double time_s = 0.0;  ///< since the simulation began; must rise
  Eigen::Vector3d gyro_body_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_body_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_local_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_local_mps = Eigen::Vector3d::Zero();
  Quaternion local_from_body = Quaternion::Identity();
};

/// One datagram: a line of JSON between line feeds, without a blank that its reader does not
/// expect, and with the word that leaves the pace to us.
std::string format_json_sensors(const JsonSensors& sensors);

}  // namespace vantage::wire::sitl
