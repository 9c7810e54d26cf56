#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/time.hpp"
#include "planner/app/node_state.hpp"

namespace vantage::planner {

/// Stage of a robot's slot.
enum class SlotStage : std::uint8_t {
  kWaiting,  ///< the slot has not begun, or its plan waits for an answer
  kDue,      ///< the slot's plan or proposal must be made now
  kMissed,   ///< the slot ended before work on its plan began
};

/// Messages that a planner node exchanges before its plan, and the times of this exchange; selected
/// by the scenario (make_plan_mode()). The default functions are those of a robot without an
/// exchange.
class PlanMode {
 public:
  virtual ~PlanMode() = default;
  PlanMode(const PlanMode&) = delete;
  PlanMode& operator=(const PlanMode&) = delete;
  PlanMode(PlanMode&&) = delete;
  PlanMode& operator=(PlanMode&&) = delete;

  /// Subscribes to the messages of teammate `name` that only this mode uses.
  virtual void subscribe_to_teammate(const std::string& /*name*/) {}
  /// Returns the time of the next call of advance().
  [[nodiscard]] virtual Time next_tick() const { return state_.inputs.slot.begin; }
  /// Continues the exchange that is under way and returns the stage of the slot.
  virtual SlotStage advance(Time now);
  /// Does the work of a slot for proposals.
  virtual void propose(Time /*now*/) {}

 protected:
  explicit PlanMode(NodeState& state) : state_(state) {}
  [[nodiscard]] NodeState& state() { return state_; }

 private:
  NodeState& state_;
};

/// Creates the mode of `state`: ExternalMode for planner.algorithm `external`, ExchangingMode for
/// local search, ProposingMode if the team expects attacks, otherwise a mode without an exchange.
/// `state` must outlive the result and the subscriptions of its bus.
std::unique_ptr<PlanMode> make_plan_mode(NodeState& state);

}  // namespace vantage::planner
