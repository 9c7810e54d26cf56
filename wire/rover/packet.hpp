#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// The rover protocol: one datagram each way, fixed layouts, little-endian. docs/guide/rovers.md has the
// bytes and the rules.

namespace vantage::wire::rover {

inline constexpr std::uint16_t kMagic = 0x5256;  ///< the letters V, R in the order of the bytes
inline constexpr std::uint8_t kProtocolVersion = 1;
inline constexpr std::size_t kCommandBytes = 40;
inline constexpr std::size_t kTelemetryBytes = 56;
/// A rover that has taken no command for so long brakes to a stop by itself.
inline constexpr double kWatchdogS = 0.2;
/// A rover says how it is this often.
inline constexpr double kTelemetryPeriodS = 0.05;

/// Bits of Command::flags.
inline constexpr std::uint32_t kDrive = 1U << 0U;          ///< else speeds are not obeyed
inline constexpr std::uint32_t kEmergencyStop = 1U << 1U;  ///< brake hardest; the rover latches it
inline constexpr std::uint32_t kReleaseStop = 1U << 2U;    ///< end a latched emergency stop

/// Bits of Telemetry::flags.
inline constexpr std::uint32_t kDriving = 1U << 0U;      ///< speeds are being obeyed
inline constexpr std::uint32_t kStopLatched = 1U << 1U;  ///< an emergency stop, asked or pressed
inline constexpr std::uint32_t kWatchdogOut = 1U << 2U;  ///< no command for kWatchdogS
inline constexpr std::uint32_t kMotorFailed = 1U << 3U;

/// What a driver asks of a rover.
struct Command {
  std::uint32_t robot = 0;      ///< the rover's number
  std::uint32_t session = 0;    ///< drawn at random by each start of a driver; never 0
  std::uint32_t sequence = 0;   ///< one more each time; wraps
  std::int64_t time_us = 0;     ///< when it was sent, in the driver's clock; only echoed
  float speed_mps = 0.0F;       ///< forwards
  float yaw_rate_radps = 0.0F;  ///< to the left
  std::uint32_t flags = 0;
  friend bool operator==(const Command&, const Command&) = default;
};

/// How a rover is.
struct Telemetry {
  std::uint32_t robot = 0;
  std::uint32_t boot = 0;              ///< drawn at random by each start of the rover
  std::uint32_t sequence = 0;          ///< from 0 at each start
  std::uint32_t session = 0;           ///< of the driver that is obeyed; 0: none yet
  std::uint32_t command_sequence = 0;  ///< of the newest command taken
  std::int64_t command_time_us = 0;    ///< that command's time
  float speed_mps = 0.0F;              ///< measured at the wheels
  float yaw_rate_radps = 0.0F;         ///< measured
  float battery_share = 0.0F;          ///< in [0, 1]
  std::uint32_t flags = 0;
  std::uint32_t refused = 0;  ///< datagrams not taken since the start
  friend bool operator==(const Telemetry&, const Telemetry&) = default;
};

/// What became of a datagram; the first that applies, in this order.
enum class [[nodiscard]] Verdict{
    kAccepted, kForeign,  ///< not this protocol
    kVersion,  kKind,     ///< a telemetry where a command was expected, or the other way round
    kLength,   kChecksum,
    kValue,  ///< a number that is not finite, a session 0 or a battery beyond [0, 1]
};
inline constexpr std::size_t kVerdicts = 7;
/// As counters write it.
const char* name_of(Verdict verdict);

std::array<std::uint8_t, kCommandBytes> encode(const Command& command);
std::array<std::uint8_t, kTelemetryBytes> encode(const Telemetry& telemetry);
/// `out` is written only when accepted. Constant time, allocates nothing.
Verdict decode(std::span<const std::uint8_t> datagram, Command& out);
Verdict decode(std::span<const std::uint8_t> datagram, Telemetry& out);

/// CRC-32 of IEEE 802.3 (reflected, polynomial 0xEDB88320, begun with and xored by ~0).
/// "123456789" gives 0xCBF43926.
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

/// True when `a` comes after `b` in a sequence that wraps at 2³² (serial number arithmetic,
/// RFC 1982).
inline bool is_after(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::int32_t>(a - b) > 0;
}

}  // namespace vantage::wire::rover
