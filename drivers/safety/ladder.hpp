#pragma once

#include <array>
#include <bitset>

#include "core/time.hpp"
#include "drivers/safety/conditions.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

using Reasons = std::bitset<kConditionsMax>;  ///< by index into conditions()

/// Operator order on the ground. It is obeyed as soon as nothing forbids it. It is dropped when
/// something has forbidden it for arm_wait_s, or at once when only the operator can clear the
/// cause.
struct GroundOrder {
  bool is_given = false;
  Time waits_since{};  ///< since when something forbids it
};

/// Last refused order and its reasons, kept until the next order.
struct Refusal {
  enum class Order { kNone, kArm, kTakeOff };
  Order order = Order::kNone;
  Reasons reasons;  ///< empty: the motors were not running
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// State of the ladder between ticks.
struct LadderState {
  models::FlightState state = models::FlightState::kIdle;
  bool wants_armed = false;  ///< ordered, and nothing forbids it
  GroundOrder arm, take_off;
  Time forbidden_at{};  ///< last time that arming was forbidden
  Time its_turn_at{};   ///< last time that this vehicle had its turn to lift
  Refusal refusal;
  bool wants_follow = false;  ///< `follow` was received, and nothing has revoked it since
  Reasons latched;            ///< acting conditions; each ends by its own rule only
  std::array<Time, kConditionsMax> since{};  ///< start of the current uninterrupted period
  std::array<Time, kConditionsMax> gone_since{};
  Reasons held;  ///< conditions that held at the last tick
  /// The running motors were not wanted and have not been seen to stop: they may stop at any
  /// moment.
  bool is_stopping = false;
  Time unwanted_at{};
};

/// Computes one tick of flight safety: FOLLOW → HOLD → LAND → KILL, the most severe condition wins.
///
/// The vehicle is on the ground when idle, and on the ground or falling when killed. A vehicle that
/// is found armed and in the air without an order of this run begins in HOLD, or in LAND if its
/// autopilot lands it. LAND ends only on the ground; KILL ends on the ground and by `arm`. HOLD
/// becomes FOLLOW when no condition demands HOLD and the operator requests it; a missing plan is
/// such a condition. An order never makes the state less severe than the latched conditions. Pure
/// function; no allocation; constant time.
LadderState step_ladder(const LadderState& before, const SafetyInputs& inputs,
                        const SafetyLimits& limits);

/// Returns the conditions that forbid arming and taking off now; empty if both are allowed.
Reasons arming_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);
/// Returns the conditions that forbid taking off but not arming.
Reasons take_off_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);

/// True if the state is follow, hold or land.
bool is_airborne(models::FlightState state);

}  // namespace vantage::drivers
