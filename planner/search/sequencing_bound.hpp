#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "planner/search/expander.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/partial_bound.hpp"

namespace vantage::planner {

/// Lower bound of the cost-to-go that accounts for travel time. Thm 6 assumes that the robot
/// measures every target in reach at every step. This bound requires travel between the regions
/// from which the targets are visible.
///
/// The relaxed problem, over static planar targets: choose at which steps which targets are
/// measured, subject to three rules.
///   (1) After a first control, a target is measured only when the robot can have reached the
///       target's disc of visibility.
///   (2) Between measurements of two targets, the path between their discs must be travelled.
///   (3) Targets measured at one step have discs that meet.
/// If a target was measured n times until step k, its cost at step k is at least c(k, n). This is
/// the cost after the best possible measurements, in the best directions, at the last n steps.
///
/// A best-first search over (numbers of measurements, earliest next measurements) solves this
/// problem. Its least open f is a valid bound at any time. The search can therefore be stopped
/// after `states_max` states or by a deadline. If discs overlap in more than kStopsMax
/// combinations, overlapping discs are merged into one region that sees all their targets.
///
/// Valid for every problem and all plans that move at every step (hovering plans are bounded by Thm
/// 6). Allocates nothing after construction.
/// Source: ours, after the observation that travel, not sensing, limits mapping with a short-range
/// sensor.
class SequencingBound : public PartialBound {
 public:
  static constexpr int kTargetsMax = 16;
  static constexpr int kStopsMax = 40;

  SequencingBound(int targets_max, int horizon_max, int states_max);

  /// Tabulates `problem`. All three arguments must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic);

  struct Answer {
    double cost = 0.0;     ///< cost of the covered targets over the steps after `depth`
    bool expired = false;  ///< the deadline expired; `cost` is a valid bound nevertheless
  };
  /// Returns the bound of a node before the last depth. Ends early when the bound is certain to
  /// reach `cutoff`. Adds one to `work_nodes` per expanded state, and checks the deadline every few
  /// states.
  Answer cost_to_go(const Pose2& at, int depth, const Blocks& blocks, double cutoff,
                    const Deadline& deadline, std::int64_t& work_nodes);
  /// Returns the bound for the node of the last cost_to_go() if its next control is `c`. It is at
  /// least the cost that cost_to_go() returned.
  [[nodiscard]] double cost_after(int c) const { return after_[index(c)]; }

 private:
  struct Stop {
    std::uint32_t targets = 0;  ///< set of targets, one bit each
    std::uint8_t steps_to[kTargetsMax] = {};
  };
  struct State {
    double f = 0.0;
    double alone = 0.0;   ///< sum of the bounds of the single targets
    double passed = 0.0;  ///< cost of the steps up to `step`; only for targets without noise
    std::uint8_t step = 0;
    std::uint8_t control = 0;  ///< the first control
    std::uint8_t looks[kTargetsMax] = {};
    std::uint8_t next[kTargetsMax] = {};  ///< earliest step of the next measurement
  };
  struct Entry {
    double f = 0.0;
    std::uint32_t state = 0;
  };

  /// Computes c(k, n) of the i-th covered target, and rests_ from c.
  void fill_costs(int i, int depth, const double* block);
  void fill_rests(int i);
  /// Returns, by `next`, Σ_{k < next} c(k, n) + c(next, n + 1) + c(next + 1, n + 2) + …: up to a
  /// constant, the target's cost after n measurements if it is measured at every step from `next`
  /// on.
  [[nodiscard]] const double* rests(int i, int n) const { return &rests_[cell(i, n, 0)]; }
  [[nodiscard]] std::size_t cell(int i, int n, int step) const {
    return (index(i) * index(horizon_ + 2) + index(n)) * index(horizon_ + 2) + index(step);
  }
  /// Returns the cost per step of target i after n measurements, for targets with a cost that does
  /// not depend on the step.
  [[nodiscard]] double cost_after_looks(int i, int n) const {
    return costs_[cell(i, n, steps_left_)];
  }
  void fill_gains(int i);
  /// Returns the least cost from a state on if at most one region is measured per step. The problem
  /// is then a schedule of unit tasks with release times, and taking the greatest gain first is
  /// optimal. Precondition: schedules_ is true.
  [[nodiscard]] double schedule(const State& state) const;
  void open_controls(const Pose2& at, double cutoff);
  void open(const State& state);
  Answer answer(double cost, bool expired);
  void find_stops();
  bool add_cliques(std::uint32_t clique, std::uint32_t candidates);
  void add_regions();
  void find_regions();
  [[nodiscard]] bool is_full() const { return stops_.size() == kStopsMax; }
  /// Opens the successors below `cutoff`. False if no target can be measured any more.
  bool expand(const State& state, double cutoff);

  int steps_left_ = 0;
  bool any_member_ = false;  ///< true: a stop begins as soon as any of its targets allows
  std::vector<LookBound> looks_;
  std::uint32_t meets_[kTargetsMax] = {};
  std::uint8_t steps_between_[kTargetsMax][kTargetsMax] = {};
  std::vector<Stop> stops_;
  std::vector<double> costs_;  ///< [i][n][k]: cost of step k of target i after n measurements
  /// [i][n][next]: least cost of target i after n measurements, with the next one at step `next`
  std::vector<double> rests_;
  std::vector<double> onwards_;
  bool schedules_ = false;              ///< no target has process noise or teammates' information
  std::vector<std::uint32_t> regions_;  ///< groups of targets with connected discs
  std::vector<double> hulls_;           ///< [i][n]: convex in n, ≤ the cost after n measurements
  std::vector<double> gains_;           ///< [i][n]: decrease of hulls_ by the next measurement
  std::vector<double> row_blocks_;
  std::vector<AveragedBlock> row_averages_;
  std::vector<Eigen::Vector2d> ends_;  ///< end positions of the controls, in the body frame
  std::vector<double> after_;
  std::vector<std::pair<double, int>> nearest_;
  std::size_t states_max_;
  std::vector<State> states_;
  std::vector<Entry> open_;
};

}  // namespace vantage::planner
