#pragma once

#include <cstdint>
#include <string>

namespace vantage::scenario {

/// Treatment of messages without a valid signature.
enum class SecurityMode {
  kOff,      ///< messages are not signed and not checked
  kWarn,     ///< checked and counted, but accepted; for use while keys are being distributed
  kRequire,  ///< messages without a valid signature are refused
};

/// Message authentication on the bus (docs/guide/security.md).
struct SecuritySpec {
  SecurityMode mode = SecurityMode::kOff;
  std::string keys;  ///< folder created by `vantage keys new`
};

/// Kind of trial in which a message was sent; part of the signed data. Messages contain the value
/// as a number.
enum class TrialMode : std::uint8_t {
  kLive = 1,        ///< at least one device is real
  kWire = 2,        ///< no real device; at least one simulated device with real driver
  kSimulation = 3,  ///< all devices are simulated directly
  kReplay = 4,      ///< replayed from a log
};

/// Returns "live", "wire", "simulation" or "replay".
const char* name_of(TrialMode mode);

}  // namespace vantage::scenario
