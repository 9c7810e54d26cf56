#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "wire/crtp/packet.hpp"

// Services of the system: supervisor (port 9), platform (port 13), link (port 15) and console (port
// 0).

namespace vantage::wire::crtp {

/// Bits of the supervisor's state.
namespace info {
inline constexpr std::uint16_t kCanArm = 1U << 0U;
inline constexpr std::uint16_t kArmed = 1U << 1U;
inline constexpr std::uint16_t kAutoArmed = 1U << 2U;  ///< the vehicle arms by itself
inline constexpr std::uint16_t kCanFly = 1U << 3U;
inline constexpr std::uint16_t kFlying = 1U << 4U;
inline constexpr std::uint16_t kTumbled = 1U << 5U;
inline constexpr std::uint16_t kLocked = 1U << 6U;  ///< locked until the vehicle is restarted
inline constexpr std::uint16_t kCrashed = 1U << 7U;
inline constexpr std::uint16_t kHighLevelActive = 1U << 8U;
inline constexpr std::uint16_t kTrajectoryDone = 1U << 9U;
inline constexpr std::uint16_t kHighLevelDisabled = 1U << 10U;
inline constexpr std::uint16_t kDeckFault = 1U << 11U;
}  // namespace info

/// Command to the supervisor (port 9 channel 1), by number.
enum class SupervisorCommand : std::uint8_t {
  kArm = 1,
  kRecover = 2,        ///< clears the crashed state, so that the vehicle can be armed again
  kEmergencyStop = 3,  ///< motors off, locked until a restart
  kStopWatchdog = 4,   ///< an emergency stop follows 1 s after the newest kStopWatchdog
};
Packet arm_request(bool is_to_arm);
/// Returns the request for a command without a parameter, that is, for each command except kArm.
Packet supervisor_request(SupervisorCommand command);
Packet info_request();

/// Returns the emergency-stop request on the localisation port, which older firmware needs.
Packet legacy_emergency_stop();

/// Request as the vehicle reads it.
struct SupervisorRequest {
  bool is_info = false;  ///< info_request(); `command` is meaningless
  SupervisorCommand command = SupervisorCommand::kArm;
  bool is_to_arm = false;
};
std::optional<SupervisorRequest> decode_supervisor_request(const Packet& packet);
/// Returns the answer to arm_request() or to kRecover.
Packet supervisor_reply(SupervisorCommand command, bool is_ok, bool state);
Packet info_reply(std::uint16_t bits);
/// Returns the bits of info_reply(); nullopt for another packet.
std::optional<std::uint16_t> decode_info_reply(const Packet& packet);

/// Version requests of the platform (port 13 channel 1), by number.
enum class PlatformRequest : std::uint8_t { kProtocol = 0, kFirmware = 1, kDevice = 2 };
/// First protocol version with a supervisor on port 9.
inline constexpr std::uint32_t kProtocolMin = 12;
Packet platform_request(PlatformRequest request);
Packet protocol_reply(std::uint32_t version);
Packet platform_text_reply(PlatformRequest request, std::string_view text);
/// Returns the protocol version; nullopt for another packet.
std::optional<std::uint32_t> decode_protocol_reply(const Packet& packet);
/// Returns the text of a reply to kFirmware or kDevice; nullopt for another packet.
std::optional<std::string> decode_platform_text(const Packet& packet, PlatformRequest request);

/// Returns a packet that the vehicle sends back unchanged. The payload is cut to kPayloadMax.
Packet echo_request(Bytes payload);
/// Return the request for the text that identifies a Crazyflie, and its answer.
Packet source_request();
Packet source_reply();

/// Returns the text of the console; nullopt for another packet.
std::optional<std::string> decode_console(const Packet& packet);

}  // namespace vantage::wire::crtp
