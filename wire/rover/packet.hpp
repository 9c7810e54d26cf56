#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// Rover protocol: one kind of datagram per direction, fixed layouts, little-endian.
// docs/reference/rover-protocol.md describes the bytes and the rules.

namespace vantage::wire::rover {

inline constexpr std::uint16_t kMagic = 0x5256;  ///< the letters V, R in byte order
inline constexpr std::uint8_t kProtocolVersion = 1;
inline constexpr std::size_t kCommandBytes = 40;
inline constexpr std::size_t kTelemetryBytes = 56;
/// s; a rover that receives no valid command for this time brakes to a stop.
inline constexpr double kWatchdogS = 0.2;
/// s; period of a rover's telemetry.
inline constexpr double kTelemetryPeriodS = 0.05;

/// Bits of Command::flags.
inline constexpr std::uint32_t kDrive = 1U << 0U;          ///< obey the speeds; 0: ignore them
inline constexpr std::uint32_t kEmergencyStop = 1U << 1U;  ///< maximum braking, latched
inline constexpr std::uint32_t kReleaseStop = 1U << 2U;    ///< release a latched emergency stop

/// Bits of Telemetry::flags.
inline constexpr std::uint32_t kDriving = 1U << 0U;  ///< speeds are obeyed
/// an emergency stop by command or button is latched
inline constexpr std::uint32_t kStopLatched = 1U << 1U;
inline constexpr std::uint32_t kWatchdogOut = 1U << 2U;  ///< no command within kWatchdogS
inline constexpr std::uint32_t kMotorFailed = 1U << 3U;

/// Command of a driver to a rover.
struct Command {
  std::uint32_t robot = 0;      ///< the rover's number
  std::uint32_t session = 0;    ///< random for each start of a driver; never 0
  std::uint32_t sequence = 0;   ///< incremented for each command; wraps
  std::int64_t time_us = 0;     ///< µs; sending time by the driver's clock; echoed
  float speed_mps = 0.0F;       ///< m/s; positive forwards
  float yaw_rate_radps = 0.0F;  ///< rad/s; positive to the left
  std::uint32_t flags = 0;
  friend bool operator==(const Command&, const Command&) = default;
};

/// State of a rover.
struct Telemetry {
  std::uint32_t robot = 0;
  std::uint32_t boot = 0;              ///< random for each start of the rover
  std::uint32_t sequence = 0;          ///< incremented for each message, from 0 at each start
  std::uint32_t session = 0;           ///< session of the driver that is obeyed; 0: none yet
  std::uint32_t command_sequence = 0;  ///< sequence of the newest accepted command
  std::int64_t command_time_us = 0;    ///< time_us of the newest accepted command
  float speed_mps = 0.0F;              ///< m/s; measured at the wheels
  float yaw_rate_radps = 0.0F;         ///< rad/s; measured
  float battery_share = 0.0F;          ///< in [0, 1]
  std::uint32_t flags = 0;
  std::uint32_t refused = 0;  ///< datagrams refused since the start
  friend bool operator==(const Telemetry&, const Telemetry&) = default;
};

/// Result of decoding a datagram: the first value that applies, in this order.
enum class [[nodiscard]] Verdict{
    kAccepted, kForeign,  ///< not this protocol
    kVersion,  kKind,     ///< telemetry instead of a command, or a command instead of telemetry
    kLength,   kChecksum,
    kValue,  ///< a number that is not finite, a session 0, or a battery outside [0, 1]
};
inline constexpr std::size_t kVerdicts = 7;
/// Returns the name used in counters.
const char* name_of(Verdict verdict);

std::array<std::uint8_t, kCommandBytes> encode(const Command& command);
std::array<std::uint8_t, kTelemetryBytes> encode(const Telemetry& telemetry);
/// Decode a datagram into `out`, which is unchanged unless the datagram is accepted. Constant time,
/// no allocation.
Verdict decode(std::span<const std::uint8_t> datagram, Command& out);
Verdict decode(std::span<const std::uint8_t> datagram, Telemetry& out);

/// Returns the CRC-32 of IEEE 802.3 (reflected polynomial 0xEDB88320, initial value and final XOR
/// ~0). "123456789" gives 0xCBF43926.
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

/// True if `a` comes after `b` in a sequence that wraps at 2³² (serial number arithmetic, RFC
/// 1982).
inline bool is_after(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::int32_t>(a - b) > 0;
}

}  // namespace vantage::wire::rover
