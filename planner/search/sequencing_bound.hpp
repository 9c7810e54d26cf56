#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/partial_bound.hpp"

namespace vantage::planner {

/// Least cost-to-go when the robot cannot be everywhere at once: Thm 6 lets it look at every target
/// in reach at every step; here it has to travel between the places from which they are seen.
///
/// The relaxed problem, over planar targets that stay: choose at which steps which targets are
/// seen, such that (1) after one of the robot's controls, target i is seen no earlier than the way
/// from there to its disc of sight takes, (2) a look at j follows one at i no sooner than the way
/// between their discs takes, and (3) targets seen at one step have discs that meet. After n looks
/// by step k a target costs at least c(k, n): the looks as good as any can be, in the best of
/// directions, at the last n steps. Its optimum is found by a best-first search of its own over
/// (looks, earliest next looks), whose least open f is a sound bound at any moment: so it may be
/// cut off after `states_max` states or by a deadline, and never grows exponentially. Where discs
/// overlap in more than kStopsMax ways, overlapping ones are merged into one place that sees all of
/// them.
///
/// Sound for every problem, for plans that move at every step (a hover is Thm 6's). Allocates
/// nothing after construction.
/// Source: ours, after the observation that travel, not sensing, limits mapping by a short-sighted
/// sensor.
class SequencingBound : public PartialBound {
 public:
  static constexpr int kTargetsMax = 16;
  static constexpr int kStopsMax = 40;

  SequencingBound(int targets_max, int horizon_max, int states_max);

  /// Tables `problem`; all three must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic);

  struct Answer {
    double cost = 0.0;     ///< of the targets that take part, over the steps after `depth`
    bool expired = false;  ///< the deadline came; `cost` is a bound nevertheless
  };
  /// Bound of a node before the last depth. Ends early when it is sure to reach `cutoff`. Adds one
  /// to `work_nodes` for each state expanded, and asks the deadline every few of them.
  Answer cost_to_go(const Pose2& at, int depth, const Blocks& blocks, double cutoff,
                    const Deadline& deadline, std::int64_t& work_nodes);
  /// What is bounded by the last answer when control `c` is the next: no less than its cost.
  [[nodiscard]] double cost_after(int c) const { return after_[index(c)]; }

 private:
  struct Stop {
    std::uint32_t targets = 0;  ///< bits
    std::uint8_t steps_to[kTargetsMax] = {};
  };
  struct State {
    double f = 0.0;
    double alone = 0.0;   ///< bound of each target by itself, summed
    double passed = 0.0;  ///< cost of the steps up to `step`; of targets without noise alone
    std::uint8_t step = 0;
    std::uint8_t control = 0;  ///< the first
    std::uint8_t looks[kTargetsMax] = {};
    std::uint8_t next[kTargetsMax] = {};  ///< earliest step of the next look
  };
  struct Entry {
    double f = 0.0;
    std::uint32_t state = 0;
  };

  /// c(k, n) of target i of those that take part, and rests_ from it.
  void fill_costs(int i, int depth, const double* block);
  void fill_rests(int i);
  /// Σ_{k < next} c(k, n) + c(next, n + 1) + c(next + 1, n + 2) + …: up to a constant, what the
  /// target costs after n looks when it is seen at every step from `next` on.
  [[nodiscard]] const double* rests(int i, int n) const { return &rests_[cell(i, n, 0)]; }
  [[nodiscard]] std::size_t cell(int i, int n, int step) const {
    return (index(i) * index(horizon_ + 2) + index(n)) * index(horizon_ + 2) + index(step);
  }
  /// Cost per step of target i after n looks, if its kind does not depend on the step.
  [[nodiscard]] double cost_after_looks(int i, int n) const {
    return costs_[cell(i, n, steps_left_)];
  }
  void fill_gains(int i);
  /// Least cost from a state on when at each step one place at most is looked at: unit tasks with
  /// release times, for which the greatest gain first is optimal. Only if schedules_.
  [[nodiscard]] double schedule(const State& state) const;
  void open_controls(const Pose2& at, double cutoff);
  void open(const State& state);
  Answer answer(double cost, bool expired);
  void find_stops();
  bool add_cliques(std::uint32_t clique, std::uint32_t candidates);
  void add_places();
  void find_places();
  [[nodiscard]] bool is_full() const { return stops_.size() == kStopsMax; }
  /// Opens what may follow, below `cutoff`. False when nothing can be seen any more.
  bool expand(const State& state, double cutoff);

  int steps_left_ = 0;
  bool any_member_ = false;  ///< stops are merged: one of the members is enough
  std::vector<LookBound> looks_;
  std::uint32_t meets_[kTargetsMax] = {};
  std::uint8_t steps_between_[kTargetsMax][kTargetsMax] = {};
  std::vector<Stop> stops_;
  std::vector<double> costs_;  ///< [i][n][k]
  std::vector<double> rests_;  ///< [i][n][next]
  std::vector<double> onwards_;
  bool schedules_ = false;             ///< all of them: no process noise, no teammates' looks
  std::vector<std::uint32_t> places_;  ///< targets whose discs hang together
  std::vector<double> hulls_;          ///< [i][n]: convex in n, ≤ the cost after n looks
  std::vector<double> gains_;          ///< [i][n]: of the next look by the hull, never rising
  std::vector<double> row_blocks_;
  std::vector<AveragedBlock> row_averages_;
  std::vector<Eigen::Vector2d> ends_;  ///< of the controls, in the body frame
  std::vector<double> after_;
  std::vector<std::pair<double, int>> nearest_;
  std::size_t states_max_;
  std::vector<State> states_;
  std::vector<Entry> open_;
};

}  // namespace vantage::planner
