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
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Least cost-to-go of plans that move at every step, for planar targets, log det costs and
/// controls whose turns are whole multiples of one: what the best single path gains, where Thm 6
/// gives every target a robot of its own that looks every way at once.
///
/// Around a reference the cost is additive over steps (LinearisedCost), and the path that gathers
/// most of what it says is found by dynamic programming over a
/// lattice: headings are exact, places are square cells, each standing for the most that any place
/// in it can tell (distance, field of view), and a control leads to every cell that the moved
/// square touches. A look's strength b along a direction counts linearly up to some b' only: what
/// is beyond tells at most ln((b + p)/(b' + p)) of the state at its step and, by data processing
/// along the Markov chain, of each later one, where p is known without any look. Right beside a
/// target that is worth most; and where no controls lead from beside one target to beside the same
/// or another within two steps, the lattice lets it count no sooner again. Whoever asks again moves
/// R towards what the best path saw: Frank and Wolfe's steps to a tighter bound.
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
  static constexpr double kEdge_m = 1e-6;  ///< cells, ranges and ways are wider by so much
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
  /// One depth of the lattice, a step count from the robot's pose.
  struct Level {
    int turns = 0;   ///< headings −turns … turns, in units
    int half = 0;    ///< cells −half … half of x and y
    int extent = 0;  ///< those that can be reached
    std::size_t begin = 0;
    [[nodiscard]] int width() const { return 2 * half + 1; }
    [[nodiscard]] std::size_t plane() const { return index(width()) * index(width()); }
    [[nodiscard]] std::size_t size() const { return index(2 * turns + 1) * plane(); }
  };
  struct Shift {
    int x = 0;
    int y = 0;
    int turn = 0;
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
  bool lay_out(std::size_t states);
  bool clear_level(int t);
  bool add_rewards(int t);
  [[nodiscard]] Look look(int m, int k, const Sensor& sensor, double dx_m, double dy_m,
                          double half_cell_m) const;
  bool gather(int t);
  void take_squares(const float* here, const Level& level, float* out) const;
  double best_first_step();
  bool follow_best(float* looked);
  /// Cells of row j that can be reached at level t: −reach … reach; −1: none.
  [[nodiscard]] int reach_of_row(int t, int j) const;
  /// What is gathered from level t on with heading n, when `rests` more steps are too soon.
  [[nodiscard]] float* plane(int t, int rests, int n) {
    const Level& level = levels_[index(t)];
    return &states_[index(waits_) * level.begin + index(rests) * level.size() +
                    index(n + level.turns) * level.plane()];
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
  int turn_most_ = 0;      ///< of one control, in units
  double unit_rad_ = 0.0;  ///< of headings
  double step_m_ = 0.0;    ///< longest way of one step
  double sight_m_ = 0.0;
  std::vector<Sensor> sensors_;
  std::vector<Shift> turns_;                ///< per control: only `turn`
  std::vector<Pose2> ends_;                 ///< per control, in the body frame
  std::vector<models::Rectangle> arounds_;  ///< per target: where it is expected
  std::vector<double> beside_m_;            ///< per target: nearer is rare; 0: not known to be

  // Of one query.
  Pose2 from_;
  int depth_ = 0;
  double cell_m_ = 0.0;
  LinearisedCost cost_;                   ///< of cost_to_go()
  const LinearisedCost* told_ = nullptr;  ///< of this query
  std::vector<float> looked_;             ///< of cost_to_go()
  std::vector<Level> levels_;
  std::vector<int> rows_;      ///< [level][|row|]: reach_of_row
  std::vector<Shift> shifts_;  ///< [heading][control]
  int shift_turns_ = 0;
  ReservedArray<float> states_;     ///< [level][rests][heading]: what is gathered from there on
  ReservedArray<float> squares_;    ///< of one level: the most of 2 × 2 cells
  ReservedArray<float> looks_;      ///< of one level: what is seen, [heading]
  ReservedArray<float> all_round_;  ///< the same whatever the heading
  ReservedArray<float> rare_;       ///< and right beside a target
  std::vector<float> row_;
  std::vector<float> rare_row_;
};

}  // namespace vantage::planner
