#pragma once

namespace vantage::models {

/// The autopilot firmware of a vehicle, which determines modes, parameters and encodings.
enum class AutopilotDialect { kPx4, kArdupilot };

/// Returns "px4" or "ardupilot".
constexpr const char* name_of(AutopilotDialect dialect) {
  return dialect == AutopilotDialect::kPx4 ? "px4" : "ardupilot";
}

}  // namespace vantage::models
