#pragma once

#include <cstddef>
#include <span>

#include "drivers/safety/inputs.hpp"
#include "drivers/safety/limits.hpp"

namespace vantage::drivers {

/// Action that a condition demands of the vehicle. The most severe acting condition decides.
enum class Severity { kNote, kHold, kLand, kKill };

/// Rule that ends the action of a condition.
enum class Clearing {
  kAtOnce,    ///< as soon as the condition has ended
  kSelf,      ///< clear_s after the condition has ended
  kOperator,  ///< after the condition has ended, by `follow` (on the ground also by `arm`)
  kGround,    ///< after the condition has ended, on the ground and disarmed
  kRearm,     ///< after the condition has ended, by `arm` on the ground
};

/// Condition of flight safety: one row of the table.
struct Condition {
  const char* name;   ///< name used in reasons and reports
  Severity severity;  ///< action in the air
  Clearing clearing;
  bool blocks_arming = false;  ///< forbids arming, and thus also taking off
  double after_s = 0.0;        ///< s; the condition must be true for this time before it acts
  const char* limit;           ///< text: the comparison with its limit
  const char* clears;          ///< text: the rule that clears the condition
  bool (*holds)(const SafetyInputs& inputs, const SafetyLimits& limits);
  bool yields = false;           ///< clears yield_s later for the vehicle that must yield
  bool blocks_take_off = false;  ///< forbids take-off, but not arming
  bool spares_pilot = false;     ///< has no effect while a pilot controls the vehicle
  bool distrusts_pose = false;   ///< stops the use of poses until the vehicle is disarmed
};

inline constexpr std::size_t kConditionsMax = 80;

/// Returns all rows, most severe first; at most kConditionsMax.
std::span<const Condition> conditions();

const char* name_of(Severity severity);
const char* name_of(Clearing clearing);

}  // namespace vantage::drivers
