#pragma once

#include <cstdint>
#include <vector>

#include "core/index.hpp"
#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// Largest difference of two gains that count as equal, nats. It is far above the rounding error of
/// a sum.
inline constexpr double kGainRounding_nats = 1e-9;

/// A set S of at most one candidate per robot. It stores each target's belief after every step, and
/// its gain, so that sets with one candidate more or less are cheap to evaluate.
///
/// An evaluation only processes the targets that the added or removed candidate measures, from its
/// first measurement on. Cost: O(measurements · robots that measure the same targets) and one
/// addition per target. Values are pure functions of the set, bit for bit: neither the history of S
/// nor the query affects them. Allocates nothing after construction, except when a target is
/// measured by more robots than before.
class TeamSet {
 public:
  /// Creates the empty set. `oracle` must outlive this object.
  explicit TeamSet(const TeamOracle& oracle);

  [[nodiscard]] const Choice& choice() const { return choice_; }
  /// Returns J(S), nats.
  [[nodiscard]] double value() const { return value_; }
  /// Returns I(S), nats.
  [[nodiscard]] double information() const;

  /// Adds `id` for its robot. Precondition: that robot has none.
  void add(CandidateId id);
  /// Removes the candidate of `robot`. Precondition: it has one.
  void drop(int robot);
  /// Changes the set to `choice` with as few additions and removals as possible.
  void become(const Choice& choice);

  /// Returns J(S ∪ {id}): one oracle call. Precondition: its robot has none.
  double value_with(CandidateId id);
  /// Returns J(S \ {candidate of `robot`}): one oracle call. Precondition: it has one.
  double value_without(int robot);
  /// Returns I(S ∪ {id}) − I(S), nats, even if its robot has another candidate: one oracle call.
  double information_gain(CandidateId id);
  /// Returns the number of oracle calls.
  [[nodiscard]] std::int64_t calls() const { return calls_; }

 private:
  struct Observer {
    int robot = 0;
    TargetCourses::Measurements measurements;
  };
  [[nodiscard]] TargetCourses::Course* courses(int target) {
    return &courses_[index(target) * depths_];
  }
  /// Returns the information gain about `target` from the robots of S, without robot `left_out` and
  /// with `added`. `first` is the step of the earliest changed measurement.
  double value_of_target(int target, int left_out, const Observer& added, int first, bool keep);
  /// Returns J of S with `id` added, or without robot `left_out`. Sums over targets and robots in a
  /// fixed order.
  double sum_with(CandidateId id, int left_out);
  void change(CandidateId id, int left_out);

  const TeamOracle* oracle_;
  std::size_t depths_;
  Choice choice_;
  double value_ = 0.0;
  std::int64_t calls_ = 0;
  std::vector<std::vector<Observer>> observers_;  ///< by target: robots that measure it, sorted
  std::vector<TargetCourses::Course> courses_;    ///< indexed by [target][step]
  std::vector<double> values_;                    ///< information gain by target, nats
  std::vector<TargetCourses::Measurements> scratch_;
};

}  // namespace vantage::planner
