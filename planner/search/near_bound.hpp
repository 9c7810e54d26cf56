#pragma once

#include <cstdint>
#include <vector>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "planner/search/averaged_block.hpp"
#include "planner/search/heuristic.hpp"
#include "planner/search/partial_bound.hpp"

namespace vantage::planner {

/// Lower bound of the cost of plans that move at every step, for planar targets with process noise.
/// Thm 6 assumes that the robot is very close to every target at every step, which is impossible. A
/// bearing from very close has 100 000 times the information of a bearing from afar.
///
/// At step k the robot is near target m if it is within ρ(m, k) of it; the discs of one step do not
/// overlap. So at most one target is near at a step. A near event can follow another after 1, 2 or
/// 3 steps only if some controls cover the required distance. If every measurement is from ρ or
/// farther, the targets cost at least Σ J̄_m (AveragedBlock). A near event at k reduces the cost
/// from k to the end by at most b(m, k), the maximum over all earlier events of m. The bound
/// subtracts the sum of these reductions along the best possible chain of events. Several disc
/// sizes are tried; the best bound is used.
///
/// Allocates nothing after construction. Source: ours.
class NearBound : public PartialBound {
 public:
  NearBound(int targets_max, int horizon_max);

  /// Tabulates `problem`. All three arguments must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs,
             const InformationHeuristic& heuristic);

  struct Answer {
    double cost = 0.0;     ///< cost of the covered targets; −∞: no bound
    bool expired = false;  ///< the deadline expired; `cost` is a valid bound nevertheless
  };
  /// Computes the bound. Adds one to `work_nodes` per several dozen recursion steps, and checks the
  /// deadline as often.
  Answer cost(const Deadline& deadline, std::int64_t& work_nodes);

 private:
  static constexpr int kHopsMax = 3;  ///< largest tabulated number of steps between events
  struct Hop {
    double least_m = 0.0;
    double most_m = 0.0;
  };

  [[nodiscard]] std::size_t at(int i, int k) const {
    return index(i) * index(horizon_ + 1) + index(k);
  }
  void tabulate_hops();
  /// Bounds ½ tr M of a measurement of target m from a distance of `least_m` or more.
  [[nodiscard]] double strongest_from(int m, double least_m) const;
  /// Sets discs of at most `radius_m`, and the information of measurements from inside and outside.
  void set_discs(double radius_m);
  /// True if an event at (j, l), l > k, can follow one at (i, k).
  [[nodiscard]] bool can_follow(int i, int k, int j, int l) const;
  [[nodiscard]] double stage(const AveragedBlock& block) const;
  /// Returns the cost of target i over the steps after k if all measurements are made from outside
  /// the disc.
  double remaining_cost_outside(int i, int k, AveragedBlock block);
  /// Computes b(i, ·) over every choice of events from step k on; `events` are the earlier events.
  void save(int i, int k, const AveragedBlock& block, std::uint32_t events);
  [[nodiscard]] double best_chain() const;
  bool work();

  const Deadline* deadline_ = nullptr;
  std::int64_t* work_nodes_ = nullptr;
  int steps_until_asking_ = 0;
  std::int64_t steps_left_ = 0;  ///< recursion steps left before this disc size is skipped
  bool expired_ = false;
  Hop hops_[kHopsMax + 1];
  std::vector<double> radii_m_;  ///< [i][k]: ρ of target i at step k
  std::vector<double> near_;     ///< [i][k]: most information from inside the disc; 0: out of reach
  std::vector<double> outside_;  ///< [i][k]: most information from ρ or farther
  std::vector<double> savings_;  ///< [i][k]: b of target i at step k
  mutable std::vector<double> chains_;
};

}  // namespace vantage::planner
