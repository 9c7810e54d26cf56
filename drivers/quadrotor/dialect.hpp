#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// A message that the driver wants to hear, and how often.
struct WantedStream {
  std::uint32_t message_id = 0;
  double rate_hz = 0.0;
};

/// In what PX4 and ArduCopter differ for this driver. Everything else is the same conversation.
struct DialectTraits {
  const char* name = "";
  std::uint8_t autopilot_id = 0;   ///< in its HEARTBEAT
  std::uint8_t own_system_id = 0;  ///< as which the driver speaks
  std::uint8_t own_type = 0;
  std::uint32_t follow_mode = 0;  ///< custom_mode in which it takes set-points
  std::uint32_t land_mode = 0;
  /// Set-points have to arrive for more than a second before the mode may be entered.
  bool wants_proof_of_life = false;
  /// It takes off by a command, and a set-point during it would end it.
  bool takes_off_by_command = false;
  /// Its estimator has no origin without a GPS, and says nothing before it has one.
  bool needs_origin = false;
  // How much earlier it is told than it is to be there; measured, with our parameters.
  double lead_s = 0.0;               ///< of place and velocity
  double acceleration_lead_s = 0.0;  ///< of the acceleration, for which it has to tilt
  std::vector<WantedStream> streams;
};

const DialectTraits& traits_of(models::AutopilotDialect dialect);

/// To enter follow_mode; to land.
wire::mavlink::CommandLong follow_mode_command(models::AutopilotDialect dialect);
wire::mavlink::CommandLong land_command(models::AutopilotDialect dialect);

/// "offboard", "land", "mode 0x3040000".
std::string mode_name(models::AutopilotDialect dialect, std::uint32_t custom_mode);

/// Somebody at a radio control flies it in that mode. In the others (landing, return, a hold of its
/// own) nobody need be there.
bool is_flown_by_hand(models::AutopilotDialect dialect, std::uint32_t custom_mode);

/// What the estimator lacks for a flight on external poses, in words; nullopt when nothing.
std::optional<std::string> estimator_fault(models::AutopilotDialect dialect, std::uint16_t flags,
                                           bool is_airborne);

/// "denied", "temporarily rejected", …
const char* result_name(std::uint8_t ack_result);
/// "arm", "take-off", …
std::string command_name(std::uint16_t command);

}  // namespace vantage::drivers
