#pragma once

#include <cstddef>
#include <span>

#include "drivers/safety/inputs.hpp"
#include "drivers/safety/limits.hpp"

namespace vantage::drivers {

/// What a condition asks of the vehicle; the most severe one that holds wins.
enum class Severity { kNote, kHold, kLand, kKill };

/// Who may end what a condition began.
enum class Clearing {
  kAtOnce,    ///< ends as soon as the condition is gone
  kSelf,      ///< ends when the condition has been gone for clear_s
  kOperator,  ///< gone, and the operator says `follow` (or `arm`, on the ground)
  kGround,    ///< gone, and the vehicle stands on the ground, disarmed
  kRearm,     ///< on the ground, and the operator says `arm` after the condition is gone
};

/// One row of the table that flight safety is.
struct Condition {
  const char* name;   ///< as reasons and reports write it
  Severity severity;  ///< in the air
  Clearing clearing;
  bool blocks_arming = false;  ///< and, with it, taking off
  double after_s = 0.0;        ///< must hold this long before it counts
  const char* limit;           ///< what is compared with what
  const char* clears;          ///< the rule, in words
  bool (*holds)(const SafetyInputs& inputs, const SafetyLimits& limits);
  bool yields = false;  ///< clears yield_s later for the vehicle that must let the other go first
  bool blocks_take_off = false;  ///< and not arming
  bool spares_pilot = false;     ///< does not act while a pilot flies the vehicle by hand
  bool distrusts_pose = false;   ///< poses are not used any more until the vehicle is disarmed
};

inline constexpr std::size_t kConditionsMax = 80;

/// All of them, most severe first. At most kConditionsMax.
std::span<const Condition> conditions();

const char* name_of(Severity severity);
const char* name_of(Clearing clearing);

}  // namespace vantage::drivers
