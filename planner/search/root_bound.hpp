#pragma once

#include <cstdint>

#include "core/deadline.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/near_bound.hpp"
#include "planner/search/prefix_bound.hpp"
#include "planner/search/sequencing_bound.hpp"

namespace vantage::planner {

/// The certificate for searches that have none of their own (ARVI, RVI, beams): bounds at the root.
/// Allocates nothing after construction.
class RootBound {
 public:
  /// of_moving_plan() is worth its time once a search has done so much work.
  static constexpr std::int64_t kWorthAfterNodes = 50'000;
  /// And raise() is, once it has done so much more: at first for so many nodes and then for a share
  /// of the search's own. In long searches, where passes find little more, for as many as those.
  static constexpr std::int64_t kRaiseAfterNodes = 300'000;
  static constexpr std::int64_t kRaiseAtFirstNodes = 500'000;
  static constexpr double kRaiseShare = 0.25;
  static constexpr std::int64_t kLongNodes = 5'000'000;

  RootBound(int targets_max, int horizon_max, int states_max = 300);

  /// Tables a problem and gives what no plan can cost less than, also one that stops and hovers on
  /// the way: Thm 6, by the larger of h and the sum of the stage floors; −∞ when nothing bounds the
  /// information. 10–100 µs. `beliefs` are those of `problem`; both must outlive the next call.
  double of_any_plan(const SearchProblem& problem, const BeliefTable& beliefs);

  /// What no plan can cost less than that takes every step from the controls, of the problem last
  /// tabled: no less than of_any_plan(), for the robot cannot look everywhere at once, nor be right
  /// beside every target. Up to `states_max` / 3 µs, and what NearBound takes (a bounded number of
  /// steps); when the deadline comes, what is bounded so far, and the search has to stop at once.
  /// Adds to `work_nodes` what it expands.
  struct Answer {
    double cost = 0.0;
    bool expired = false;
  };
  Answer of_moving_plan(const Deadline& deadline, std::int64_t& work_nodes);

  /// The same, raised by PrefixBound until `work_nodes` is at `until_nodes`; goes on from where the
  /// last call ended. `expander` is reset to the problem last tabled.
  Answer raise(Expander& expander, std::int64_t until_nodes, const Deadline& deadline,
               std::int64_t& work_nodes);

  /// Takes all the memory that was reserved.
  void prefault() { prefix_.prefault(); }

 private:
  InformationHeuristic heuristic_;
  SequencingBound sequencing_;
  NearBound near_;
  PrefixBound prefix_;
  const SearchProblem* problem_ = nullptr;
  bool is_raised_ = false;  ///< prefix_ is of this problem
  Pose2 start_;
  double any_plan_ = 0.0;
  double reach_ = 0.0;       ///< h at the root
  double others_ = 0.0;      ///< of the targets that take no part in a sequence
  double not_moving_ = 0.0;  ///< of those that take no part in near_
};

}  // namespace vantage::planner
