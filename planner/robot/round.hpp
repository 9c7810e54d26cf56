#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// The time-triggered planning round: no leader, no acknowledgement.
///
/// Round k starts at t_k = k · n_exec · τ on the common clock. The team's budget B lies at the end
/// of the round, [t_{k+1} − m − B, t_{k+1} − m), so that plans act on fresh beliefs; robot i of N
/// owns the i-th N-th of it. All robots switch to their new plans at t_{k+1}.
///
/// A team that is larger than planner.slots, S > 0, parts it in S, whatever N is: each slot is of
/// robots that are not near each other, and which one a robot has changes
/// (planner/robot/slot_colour).
///
/// In a team that expects attacks the first half of the budget is parted alike for proposals, the
/// second half for plans: when the first plan is made, all have told what they would do alone.
/// In a team that plans by local search all robots exchange proposals at once in the first half.
/// Source: docs/decisions/0003, 0006, 0016; dissertation 3 (coordinate descent on a network).
class RoundSchedule {
 public:
  /// @param robot_index in [0, robot_count)
  RoundSchedule(const scenario::PlannerSpec& spec, int robot_index, int robot_count);

  struct Slot {
    std::int64_t round = 0;
    Time begin{};
    Time end{};         ///< the plan must be published by then
    Time activation{};  ///< t_{k+1}, when the plan starts
    bool is_proposal = false;
    int place = 0;  ///< which of the round's slots it is
  };
  /// This robot's first slot that begins after `now`, for a proposal or a plan.
  [[nodiscard]] Slot next_slot(Time now) const;
  /// This robot's slot of round k for its plan.
  [[nodiscard]] Slot slot(std::int64_t round) const;
  /// Slot `place` of round k. Precondition: 0 ≤ place < slots().
  [[nodiscard]] Slot slot(std::int64_t round, int place) const;
  /// Slot `place` of the first round after `round` in which it begins after `now`.
  [[nodiscard]] Slot slot_after(std::int64_t round, Time now, int place) const;
  [[nodiscard]] bool is_shared() const { return is_shared_; }
  [[nodiscard]] int slots() const { return slots_; }
  /// The robot's slot until others are heard in it.
  [[nodiscard]] int first_place() const { return place_; }
  /// Which slot of its round `plan` was made in; nullopt: of another schedule.
  [[nodiscard]] std::optional<int> place_of(const models::RobotPlan& plan) const;
  /// The one for its proposals. Precondition: the team expects attacks or plans by local search.
  [[nodiscard]] Slot proposal_slot(std::int64_t round) const;
  [[nodiscard]] Duration round_length() const { return round_; }

 private:
  [[nodiscard]] Slot part_of(std::int64_t round, int place, Duration from, Duration length) const;

  Duration round_{};
  Duration margin_{};
  Duration budget_{};
  bool is_shared_ = false;  ///< slots are of several robots
  int slots_ = 1;           ///< else as many as robots
  int place_ = 0;
  bool is_exchange_ = false;  ///< the first half is everybody's
  bool has_proposals_ = false;
};

}  // namespace vantage::planner
