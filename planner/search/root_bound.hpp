#pragma once

#include <cstdint>

#include "core/deadline.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/near_bound.hpp"
#include "planner/search/prefix_bound.hpp"
#include "planner/search/sequencing_bound.hpp"
#include "planner/search/terminal_bound.hpp"

namespace vantage::planner {

/// Lower bounds at the root for searches without a bound of their own (ARVI, RVI, beams). They
/// include the problem's terminal value. Allocates nothing after construction.
class RootBound {
 public:
  /// Search work, in nodes, after which of_moving_plan() is used.
  static constexpr std::int64_t kMovingBoundAfterNodes = 50'000;
  /// Search work, in nodes, after which raise() is used. raise() first gets kRaiseAtFirstNodes
  /// nodes, then a share of the search's nodes. In long searches, where further passes improve
  /// little, it gets as many nodes as the passes.
  static constexpr std::int64_t kRaiseAfterNodes = 300'000;
  static constexpr std::int64_t kRaiseAtFirstNodes = 500'000;
  static constexpr double kRaiseShare = 0.25;
  static constexpr std::int64_t kLongNodes = 5'000'000;

  RootBound(int targets_max, int horizon_max, int states_max = 300);

  /// Tabulates a problem and returns a lower bound of every plan, including those that stop and
  /// hover: the larger of h (Thm 6) and the sum of the stage floors; −∞ if the information is
  /// unbounded. Takes 10–100 µs. `beliefs` must be those of `problem`; both must outlive the next
  /// call.
  double of_any_plan(const SearchProblem& problem, const BeliefTable& beliefs);

  /// Lower bound of every plan that takes all steps from the controls, for the problem last
  /// tabulated. It is at least of_any_plan(), because it takes into account that the robot cannot
  /// measure or approach all targets at the same time. Takes up to `states_max` / 3 µs, plus
  /// NearBound's bounded number of steps. If the deadline expires, returns the bound so far, and
  /// the search must stop. Adds the expanded states to `work_nodes`.
  struct Answer {
    double cost = 0.0;
    bool expired = false;
  };
  Answer of_moving_plan(const Deadline& deadline, std::int64_t& work_nodes);

  /// As above, improved by PrefixBound until `work_nodes` reaches `until_nodes`; continues from the
  /// last call. Call expander.reset() with the same problem before.
  Answer raise(Expander& expander, std::int64_t until_nodes, const Deadline& deadline,
               std::int64_t& work_nodes);

  /// Commits the first MiB of each array.
  void prefault() { prefix_.prefault(); }

 private:
  InformationHeuristic heuristic_;
  SequencingBound sequencing_;
  NearBound near_;
  PrefixBound prefix_;
  TerminalBound terminal_;  ///< bound of the terminal value, added to bounds of J_T
  const SearchProblem* problem_ = nullptr;
  bool is_raised_ = false;  ///< prefix_ is tabulated for this problem
  Pose2 start_;
  double any_plan_ = 0.0;      ///< without the terminal value, like the next members
  double reach_ = 0.0;         ///< h at the root
  double others_ = 0.0;        ///< h of the targets outside sequencing_
  double outside_near_ = 0.0;  ///< h of the targets outside near_
};

}  // namespace vantage::planner
