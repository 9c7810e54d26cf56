#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// Message that the driver requests from the autopilot, with its rate.
struct WantedStream {
  std::uint32_t message_id = 0;
  double rate_hz = 0.0;
};

/// Differences between PX4 and ArduCopter for this driver. Everything else is identical.
struct DialectTraits {
  const char* name = "";
  std::uint8_t autopilot_id = 0;   ///< field `autopilot` of its HEARTBEAT
  std::uint8_t own_system_id = 0;  ///< system id of the driver
  std::uint8_t own_type = 0;
  std::uint32_t follow_mode = 0;  ///< custom_mode in which set-points are accepted
  std::uint32_t land_mode = 0;
  /// True if set-points must arrive for more than a second before follow_mode can be entered.
  bool wants_proof_of_life = false;
  /// True if the autopilot takes off by a command; a set-point would end the take-off.
  bool takes_off_by_command = false;
  /// True if the driver must set the estimator's origin: without an origin the estimator publishes
  /// nothing.
  bool needs_origin = false;
  // Time by which set-points are computed ahead; measured with the parameters of config/autopilot.
  double lead_s = 0.0;  ///< s; lead of position and velocity
  /// s; lead of the acceleration, because the vehicle must tilt first
  double acceleration_lead_s = 0.0;
  std::vector<WantedStream> streams;
};

const DialectTraits& traits_of(models::AutopilotDialect dialect);

/// Return the command that enters follow_mode, or the command that lands.
wire::mavlink::CommandLong follow_mode_command(models::AutopilotDialect dialect);
wire::mavlink::CommandLong land_command(models::AutopilotDialect dialect);

/// Returns the name of a mode: "offboard", "land", "mode 0x3040000".
std::string mode_name(models::AutopilotDialect dialect, std::uint32_t custom_mode);

/// True if a pilot controls the vehicle in that mode. The other modes (landing, return, autonomous
/// hold) need no pilot.
bool is_flown_by_hand(models::AutopilotDialect dialect, std::uint32_t custom_mode);

/// Returns a text that lists the missing estimates that a flight with external poses needs; nullopt
/// if none is missing.
std::optional<std::string> estimator_fault(models::AutopilotDialect dialect, std::uint16_t flags,
                                           bool is_airborne);

/// Returns the name of an acknowledgement result: "denied", "temporarily rejected", …
const char* result_name(std::uint8_t ack_result);
/// Returns the name of a command: "arm", "take-off", …
std::string command_name(std::uint16_t command);

}  // namespace vantage::drivers
