#pragma once

#include <array>
#include <bitset>

#include "core/time.hpp"
#include "drivers/safety/conditions.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

using Reasons = std::bitset<kConditionsMax>;  ///< by index into conditions()

/// An order of the operator's on the ground: obeyed as soon as nothing forbids it, forgotten when
/// something has forbidden it for arm_wait_s or only the operator may end what does.
struct GroundOrder {
  bool is_given = false;
  Time waits_since{};  ///< something forbids it since then
};

/// Which order came to nothing, and why; until the next order.
struct Refusal {
  enum class Order { kNone, kArm, kTakeOff };
  Order order = Order::kNone;
  Reasons reasons;  ///< none: the motors were not running
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// What the ladder remembers from one tick to the next.
struct LadderState {
  models::FlightState state = models::FlightState::kIdle;
  bool wants_armed = false;  ///< ordered, and nothing forbids it now
  GroundOrder arm, take_off;
  Time forbidden_at{};  ///< when arming was last forbidden
  Time its_turn_at{};   ///< when it was last its own turn to lift
  Refusal refusal;
  bool wants_follow = false;                 ///< `follow` was said and nothing since took it back
  Reasons latched;                           ///< act now; ended only by their rule
  std::array<Time, kConditionsMax> since{};  ///< the condition holds without a break
  std::array<Time, kConditionsMax> gone_since{};
  Reasons held;  ///< condition held at the last tick
  /// Motors that turn were not wanted, and have not been seen to stop: they may do so at any
  /// moment.
  bool is_stopping = false;
  Time unwanted_at{};
};

/// One tick of flight safety: FOLLOW → HOLD → LAND → KILL, the most severe condition wins.
///
/// Idle and killed are on or headed for the ground; a vehicle that is found flying, armed and in
/// the air without an order of this run, begins in HOLD, or in LAND when it lands by itself. LAND
/// ends on the ground only, KILL on the ground and by `arm`. HOLD becomes FOLLOW when nothing asks
/// for HOLD any more, a checked plan is there and the operator wants it. A command never makes the
/// state less severe than the latched conditions. Pure: the same arguments give the same answer; no
/// allocation; constant time.
LadderState step_ladder(const LadderState& before, const SafetyInputs& inputs,
                        const SafetyLimits& limits);

/// The conditions that forbid arming and taking off now: none means the vehicle may.
Reasons arming_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);
/// Those that forbid taking off and not arming.
Reasons take_off_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);

/// True while the vehicle is in the air by our knowledge: following, holding or landing.
bool is_airborne(models::FlightState state);

}  // namespace vantage::drivers
