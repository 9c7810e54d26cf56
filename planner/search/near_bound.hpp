#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "planner/search/averaged_block.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/partial_bound.hpp"

namespace vantage::planner {

/// Least cost of a plan that moves at every step, for planar targets that move or spread: the robot
/// cannot be right beside every target at every step, though Thm 6 has it so, and beside a target a
/// bearing tells a hundred thousand times as much as from afar.
///
/// At step k the robot is near target m when it is within ρ(m, k) of it, where these discs touch no
/// other at the same step. So at most one target is near at a step, and one near event follows
/// another 1 … 3 steps later only if some controls lead so far and no farther. With every look from
/// ρ or farther the targets cost Σ J̄_m at least (AveragedBlock); a near event at k adds at most
/// b(m, k), the most that it can save, over all earlier events of m, from k to the end. The sum of
/// these along the best possible chain of events is taken off. Several sizes of discs are tried;
/// the best bound counts.
///
/// Allocates nothing after construction. Source: ours.
class NearBound : public PartialBound {
 public:
  NearBound(int targets_max, int horizon_max);

  /// Tables `problem`; all three must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic);

  struct Answer {
    double cost = 0.0;     ///< of the targets that take part; −∞: not bounded
    bool expired = false;  ///< the deadline came; `cost` is a bound nevertheless
  };
  /// Adds to `work_nodes` one for some dozens of recursion steps, and asks the deadline as often.
  Answer cost(const Deadline& deadline, std::int64_t& work_nodes);

 private:
  static constexpr int kHopsMax = 3;  ///< steps over which ways between events are tabled
  struct Hop {
    double least_m = 0.0;
    double most_m = 0.0;
  };

  [[nodiscard]] std::size_t at(int i, int k) const {
    return index(i) * index(horizon_ + 1) + index(k);
  }
  void tabulate_hops();
  /// ½ tr M of a look at target m from anywhere `least_m` away or farther, at most.
  [[nodiscard]] double strongest_from(int m, double least_m) const;
  /// Discs of at most `radius_m`, and what looks tell inside and outside of them.
  void set_discs(double radius_m);
  /// Whether an event at (j, l), l > k, can follow one at (i, k).
  [[nodiscard]] bool can_follow(int i, int k, int j, int l) const;
  [[nodiscard]] double stage(const AveragedBlock& block) const;
  /// Cost of target i over the steps after k, all looks from outside the disc.
  double rest_from_afar(int i, int k, AveragedBlock block);
  /// Fills b(i, ·): every choice of events from step k on, those before in events_.
  void save(int i, int k, const AveragedBlock& block, std::uint32_t events);
  [[nodiscard]] double best_chain() const;
  bool work();

  const Deadline* deadline_ = nullptr;
  std::int64_t* work_nodes_ = nullptr;
  int steps_until_asking_ = 0;
  std::int64_t steps_left_ = 0;  ///< of recursion, before this size of discs is given up
  bool expired_ = false;
  Hop hops_[kHopsMax + 1];
  std::vector<double> radii_m_;  ///< ρ, [i][k]
  std::vector<double> near_;     ///< strength of a look at its best, [i][k]; 0: out of reach
  std::vector<double> afar_;     ///< the same from ρ or farther
  std::vector<double> savings_;  ///< b, [i][k]
  mutable std::vector<double> chains_;
};

}  // namespace vantage::planner
