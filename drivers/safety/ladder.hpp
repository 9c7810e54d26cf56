#pragma once

#include <array>
#include <bitset>

#include "core/time.hpp"
#include "drivers/safety/conditions.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

using Reasons = std::bitset<kConditionsMax>;  ///< set of conditions, by index into conditions()

/// Operator command on the ground. It is obeyed as soon as no condition forbids it. It is dropped
/// if a condition has forbidden it for arm_wait_s, or immediately if only the operator can clear
/// the condition.
struct GroundOrder {
  bool is_given = false;
  Time waits_since{};  ///< time since which a condition forbids the order
};

/// Last refused command and its reasons, stored until the next command.
struct Refusal {
  enum class Order { kNone, kArm, kTakeOff };
  Order order = Order::kNone;
  Reasons reasons;  ///< reasons of the refusal; empty: the motors were not running
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// State of the ladder between ticks.
struct LadderState {
  models::FlightState state = models::FlightState::kIdle;
  bool wants_armed = false;  ///< arming was commanded, and no condition forbids it
  GroundOrder arm, take_off;
  Time forbidden_at{};  ///< last time at which arming was forbidden
  Time its_turn_at{};   ///< last time at which it was this vehicle's turn to lift
  Refusal refusal;
  bool wants_follow = false;  ///< `follow` was received and has not been revoked
  Reasons latched;            ///< acting conditions; each ends only by its clearing rule
  std::array<Time, kConditionsMax> since{};  ///< time since which each condition is true
  std::array<Time, kConditionsMax> gone_since{};
  Reasons held;  ///< conditions that were true at the last tick
  /// The running motors were commanded to stop, but are not reported as stopped: they may stop at
  /// any moment.
  bool is_stopping = false;
  Time unwanted_at{};
};

/// Computes one tick of flight safety: FOLLOW → HOLD → LAND → KILL. The most severe condition
/// decides.
///
/// The vehicle is on the ground when idle, and on the ground or falling when killed. A vehicle that
/// is already armed and in the air when its driver starts begins in HOLD, or in LAND if its
/// autopilot is landing it. LAND ends only on the ground; KILL ends on the ground and by `arm`.
/// HOLD becomes FOLLOW when no condition demands HOLD and the operator requests it; a missing plan
/// is such a condition. A command never makes the state less severe than the latched conditions
/// require. Pure function; no allocation; constant time.
LadderState step_ladder(const LadderState& before, const SafetyInputs& inputs,
                        const SafetyLimits& limits);

/// Returns the conditions that forbid arming and taking off now; empty if both are allowed.
Reasons arming_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);
/// Returns the conditions that forbid taking off but not arming.
Reasons take_off_blocks(const SafetyInputs& inputs, const SafetyLimits& limits);

/// True if the state is follow, hold or land.
bool is_airborne(models::FlightState state);

}  // namespace vantage::drivers
