#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/deadline.hpp"
#include "core/index.hpp"
#include "core/reserved_array.hpp"
#include "planner/problem/belief_table.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/linearised_cost.hpp"
#include "planner/search/reach_lattice.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Least cost-to-go of plans that move at every step, for planar targets, log det costs and
/// controls whose turns are whole multiples of one: what the best single path gains, where Thm 6
/// gives every target a robot of its own that looks every way at once.
///
/// Around a reference the cost is additive over steps (LinearisedCost), and the path that gathers
/// most of what it says is found by dynamic programming over a lattice (ReachLattice): a cell
/// stands for the most that any place in it can tell (distance, field of view), and a control leads
/// to every cell that the moved square touches. A look's strength b along a direction counts
/// linearly up to some b' only: what is beyond tells at most ln((b + p)/(b' + p)) of the state at
/// its step and, by data processing along the Markov chain, of each later one, where p is known
/// without any look. Right beside a target that is worth most; and where no controls lead from
/// beside one target to beside the same or another within two steps, the lattice lets it count no
/// sooner again. Whoever asks again moves R towards what the best path saw: Frank and Wolfe's steps
/// to a tighter bound.
///
/// Allocates nothing after construction. Source: ours; Frank & Wolfe 1956.
class LatticeBound {
 public:
  LatticeBound(int targets_max, int horizon_max, std::size_t states_max);

  /// Takes all the memory that was reserved.
  void prefault();

  /// Tables `problem`; both must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs);

  /// Whether it bounds nothing of this problem.
  [[nodiscard]] bool is_empty() const { return !applies_; }

  /// Floats in a reference, see LinearisedCost.
  [[nodiscard]] std::size_t reference_size() const { return cost_.reference_size(); }
  /// A reference to begin with: a weak look at all that is in reach of the start.
  void begin(float* reference) const;

  struct Answer {
    double cost = 0.0;     ///< −∞: nothing is known
    bool expired = false;  ///< the deadline came
  };
  /// A bound on the cost of the steps after `depth` for a robot at `at` that knows `blocks`; moves
  /// `reference` by `share` towards the looks of the lattice's best path. The lattice has
  /// `states` states at most. Adds to `work_nodes` about what the time would be in nodes.
  Answer cost_to_go(const Pose2& at, int depth, const Blocks& blocks, float* reference,
                    double share, std::size_t states, const Deadline& deadline,
                    std::int64_t& work_nodes);

  /// Tells `cost` which targets a robot at `at` can come near after `depth`.
  void mark_reached(const Pose2& at, int depth, LinearisedCost& cost) const;

  struct Path {
    double gained = 0.0;  ///< Σ ⟨G, M⟩ at most, of M capped where looks saturate; ∞: not known
    bool expired = false;
  };
  /// The most that a path from `at` after `depth` gathers of what `cost` says; where `looked` is
  /// not null, what the best path over the lattice sees is added to it, as long as a reference.
  Path best_path(const Pose2& at, int depth, const LinearisedCost& cost, float* looked,
                 std::size_t states, const Deadline& deadline, std::int64_t& work_nodes);

 private:
  static constexpr float kNever = -1e30F;  ///< no path leads here
  static constexpr int kWaitsMax = 3;
  static constexpr std::size_t kTargetNodes = 200;  ///< to linearise a target or follow a step …
  static constexpr std::size_t kMovesANode = 150;   ///< … and moves to a cell in the time of one

  /// What a sensor tells of a planar target.
  struct Sensor {
    double range_max_m = 0.0;
    double range_min_m = 0.0;
    double half_fov_rad = 0.0;
    double along = 0.0;
    double across = 0.0;
    double all_ways = 0.0;
    double growth_per_m = 0.0;
    double variance_floor = 0.0;
    bool grows = false;
  };
  /// What looks at a target are worth at one depth, in the frame of the pose asked about. A
  /// direction θ asks mean + half_difference cos 2θ + xy sin 2θ of the gradient.
  struct Price {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  ///< where the target is expected
    double mean = 0.0;
    double half_difference = 0.0;
    double xy = 0.0;
    double amplitude = 0.0;
    double weight = 0.0;
    double known = 0.0;
    double beside_m = 0.0;
  };
  /// A look of one sensor from a cell at its best, and how much of it counts linearly.
  struct Look {
    double reward = 0.0;
    double beside = 0.0;  ///< more, where that is rare
    double along = 0.0;
    double across = 0.0;
    double half_angle_rad = 0.0;
  };

  void find_rare();
  bool clear_level(int t);
  bool add_rewards(int t);
  [[nodiscard]] Price price(int m, int k) const;
  static Look look(const Price& price, const Sensor& sensor, double dx_m, double dy_m,
                   double half_cell_m);
  bool gather(int t);
  /// What follows the cells of a row with heading n, when `rests` more steps are too soon.
  void take_next(int t, int n, int j, ReachLattice::Row row, int rests, float* most) const;
  static void take_squares(const float* here, const ReachLattice::Plane& plane, float* out);
  [[nodiscard]] double best_first_step() const;
  bool follow_best(float* looked);
  /// The cell that a control leads to from the start.
  [[nodiscard]] ReachLattice::Shift first_cell(std::size_t control) const;
  /// What is gathered from level t on with heading n, when `rests` more steps are too soon.
  [[nodiscard]] std::size_t begin_of(int t, int rests, int n) const {
    const ReachLattice::Level& level = layout_->levels[index(t)];
    return index(waits_) * level.begin + index(rests) * level.size + layout_->plane(t, n).begin;
  }
  bool work(std::size_t nodes);

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  const Deadline* deadline_ = nullptr;
  std::int64_t* work_nodes_ = nullptr;
  bool applies_ = false;
  int waits_ = 1;  ///< steps from one rare event to the next, at least
  int targets_ = 0;
  int horizon_ = 0;
  double sight_m_ = 0.0;
  std::vector<Sensor> sensors_;
  std::vector<models::Rectangle> arounds_;  ///< per target: where it is expected
  std::vector<double> beside_m_;            ///< per target: nearer is rare; 0: not known to be
  ReachLattice reach_;

  // Of one query.
  Pose2 from_;
  int depth_ = 0;
  LinearisedCost cost_;                   ///< of cost_to_go()
  const LinearisedCost* told_ = nullptr;  ///< of this query
  const ReachLattice::Layout* layout_ = nullptr;
  std::vector<float> looked_;       ///< of cost_to_go()
  ReservedArray<float> states_;     ///< [level][rests][heading]: what is gathered from there on
  ReservedArray<float> squares_;    ///< of one level: the most of 2 × 2 cells
  ReservedArray<float> looks_;      ///< of one level: what is seen, [heading]
  ReservedArray<float> all_round_;  ///< the same whatever the heading
  ReservedArray<float> rare_;       ///< and right beside a target
  std::vector<float> row_;
  std::vector<float> rare_row_;
};

}  // namespace vantage::planner
