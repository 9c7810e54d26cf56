#pragma once

namespace vantage::models {

/// Which autopilot's ways a vehicle has.
enum class AutopilotDialect { kPx4, kArdupilot };

/// "px4", "ardupilot".
constexpr const char* name_of(AutopilotDialect dialect) {
  return dialect == AutopilotDialect::kPx4 ? "px4" : "ardupilot";
}

}  // namespace vantage::models
