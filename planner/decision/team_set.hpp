#pragma once

#include <cstdint>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// Gains that differ by no more are equal, nats: far above the error of a sum.
inline constexpr double kGainRounding_nats = 1e-9;

/// A set S of at most one candidate for each robot, with everything kept that makes the value of
/// its neighbours cheap: each target's belief after every step, and what it has brought.
///
/// A neighbour's value costs only the targets that the candidate sees, from its first look on:
/// O(looks · robots that see them) and one addition a target. values are pure functions of the set,
/// to the bit: neither the order in which S came about nor the way it is asked matters.
/// Allocates nothing after construction but where a target is seen by more robots than ever.
class TeamSet {
 public:
  /// Nobody does anything. `oracle` must outlive this.
  explicit TeamSet(const TeamOracle& oracle);

  [[nodiscard]] const Choice& choice() const { return choice_; }
  /// J(S), nats.
  [[nodiscard]] double value() const { return value_; }
  /// I(S), nats.
  [[nodiscard]] double information() const;

  /// Gives `id` to its robot. Precondition: that robot has none.
  void add(CandidateId id);
  /// Takes what `robot` has. Precondition: it has one.
  void drop(int robot);
  /// Becomes `choice`, by as few of both as it takes.
  void become(const Choice& choice);

  /// J(S ∪ {id}): one oracle call. Precondition: its robot has none.
  double value_with(CandidateId id);
  /// J(S \ {what `robot` has}): one oracle call. Precondition: it has one.
  double value_without(int robot);
  /// I(S ∪ {id}) − I(S), nats, also where its robot has another: one oracle call.
  double information_gain(CandidateId id);
  /// Oracle calls so far.
  [[nodiscard]] std::int64_t calls() const { return calls_; }

 private:
  struct Seer {
    int robot = 0;
    TargetCourses::Looks looks;
  };
  [[nodiscard]] TargetCourses::Course* courses(int target) {
    return &courses_[static_cast<std::size_t>(target) * depths_];
  }
  /// What target is worth once its seers are those of S but `left_out`, with `added` beside them;
  /// `first` is the earliest look that changes.
  double value_of_target(int target, int left_out, const Seer& added, int first, bool keep);
  /// Sums over targets and robots, in their order: with `id` added or `robot` left out.
  double sum_with(CandidateId id, int left_out);
  void change(CandidateId id, int left_out);

  const TeamOracle* oracle_;
  std::size_t depths_;
  Choice choice_;
  double value_ = 0.0;
  std::int64_t calls_ = 0;
  std::vector<std::vector<Seer>> seers_;        ///< per target, by robot
  std::vector<TargetCourses::Course> courses_;  ///< [target][step]
  std::vector<double> values_;                  ///< per target, nats
  std::vector<TargetCourses::Looks> scratch_;
};

}  // namespace vantage::planner
