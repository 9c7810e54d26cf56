#pragma once

#include <cstdint>
#include <string>

namespace vantage::scenario {

/// What becomes of messages that are not signed as they should be.
enum class SecurityMode {
  kOff,      ///< nobody signs, nobody looks
  kWarn,     ///< signed, judged and counted, and taken all the same: while keys are handed out
  kRequire,  ///< refused
};

/// Who is believed on the bus (docs/guide/security.md).
struct SecuritySpec {
  SecurityMode mode = SecurityMode::kOff;
  std::string keys;  ///< the folder that `vantage keys new` made
};

/// In what kind of trial a message was said; it is part of what is signed. Numbers are the wire's.
enum class TrialMode : std::uint8_t {
  kLive = 1,        ///< a device is real
  kWire = 2,        ///< none is, and one has its real protocol and driver
  kSimulation = 3,  ///< all are simulated outright
  kReplay = 4,      ///< said again from a log
};

/// "live", "wire", "simulation", "replay".
const char* name_of(TrialMode mode);

}  // namespace vantage::scenario
