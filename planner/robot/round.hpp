#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// The time-triggered planning round: no leader, no acknowledgement.
///
/// Round k starts at t_k = k · n_exec · τ on the common clock (n_exec = execute_steps, τ = step_s).
/// The team's budget B lies at the end of the round, [t_{k+1} − m − B, t_{k+1} − m) with the margin
/// m, so that plans use recent beliefs. Robot i of N owns the i-th of N equal parts of the budget.
/// All robots switch to their new plans at t_{k+1}.
///
/// A team larger than planner.slots, S > 0, divides the budget into S parts, for any N. Each slot
/// is shared by robots that are not near each other, and a robot's slot can change
/// (planner/robot/slot_colour).
///
/// In a team that expects attacks the first half of the budget is divided in the same way for
/// proposals, the second half for plans: all robots have proposed the plans that they made alone
/// before the first plan is made. In a team that plans by local search all robots exchange
/// proposals concurrently in the first half.
/// Source: docs/decisions/0003, 0006, 0016; dissertation, chapter 3 (coordinate descent on a
/// network).
class RoundSchedule {
 public:
  /// @param robot_index in [0, robot_count)
  RoundSchedule(const scenario::PlannerSpec& spec, int robot_index, int robot_count);

  struct Slot {
    std::int64_t round = 0;
    Time begin{};
    Time end{};         ///< deadline to publish the plan
    Time activation{};  ///< t_{k+1}, start of the plan
    bool is_proposal = false;
    int slot_index = 0;  ///< slot number within the round
  };
  /// Returns this robot's first slot that begins after `now`, for a proposal or a plan.
  [[nodiscard]] Slot next_slot(Time now) const;
  /// Returns this robot's slot of round k for its plan.
  [[nodiscard]] Slot slot(std::int64_t round) const;
  /// Returns slot `slot_index` of round k. Precondition: 0 ≤ slot_index < slots().
  [[nodiscard]] Slot slot(std::int64_t round, int slot_index) const;
  /// Returns slot `slot_index` of the first round after `round` in which this slot begins after
  /// `now`.
  [[nodiscard]] Slot slot_after(std::int64_t round, Time now, int slot_index) const;
  [[nodiscard]] bool is_shared() const { return is_shared_; }
  [[nodiscard]] int slots() const { return slots_; }
  /// Returns the number of the robot's initial slot, used until a neighbour's plan shows a
  /// conflict.
  [[nodiscard]] int first_slot_index() const { return slot_index_; }
  /// Returns the slot number in which `plan` was made; nullopt if it was made in another schedule.
  [[nodiscard]] std::optional<int> slot_index_of(const models::RobotPlan& plan) const;
  /// Returns this robot's slot for proposals. Precondition: the team expects attacks or plans by
  /// local search.
  [[nodiscard]] Slot proposal_slot(std::int64_t round) const;
  [[nodiscard]] Duration round_length() const { return round_; }

 private:
  [[nodiscard]] Slot part_of(std::int64_t round, int slot_index, Duration from,
                             Duration length) const;

  Duration round_{};
  Duration margin_{};
  Duration budget_{};
  bool is_shared_ = false;  ///< true: a slot can belong to several robots
  int slots_ = 1;           ///< number of slots; if not shared, the number of robots
  int slot_index_ = 0;
  /// true: all robots share the first half of the budget for their exchange
  bool is_exchange_ = false;
  bool has_proposals_ = false;
};

}  // namespace vantage::planner
