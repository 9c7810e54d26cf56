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

/// Lower bound of the cost-to-go of plans that move at every step, for planar targets, log det
/// costs and turns that are integer multiples of one angle. It bounds the gain of the best single
/// path. Thm 6 is weaker: for every target it assumes a separate robot, which measures in all
/// directions.
///
/// Around a reference R the cost is additive over steps (LinearisedCost). Dynamic programming over
/// a lattice (ReachLattice) finds the path with the greatest linearised gain. The value of a cell
/// is the best measurement from any position in it (distance, field of view). A control leads to
/// every cell that the moved square touches. Information b along a direction counts linearly only
/// up to a limit b'. The excess adds at most ln((b + p)/(b' + p)) nats about the state at its step,
/// where p is the information without measurements. By data processing along the Markov chain the
/// same bound holds for each later state.
///
/// Measurements very close to a target have the greatest gain. If no controls lead from one such
/// position to another within two steps, the lattice counts this rare gain at most every third
/// step. Repeated calls move R towards the information of the best path; these Frank-Wolfe steps
/// tighten the bound.
///
/// Allocates nothing after construction. Source: ours; Frank & Wolfe 1956.
class LatticeBound {
 public:
  LatticeBound(int targets_max, int horizon_max, std::size_t states_max);

  /// Commits the first MiB of each array.
  void prefault();

  /// Tabulates `problem`. `problem` and `beliefs` must outlive the queries.
  void reset(const SearchProblem& problem, const BeliefTable& beliefs);

  /// True if this problem cannot be bounded.
  [[nodiscard]] bool is_empty() const { return !applies_; }

  /// Returns the number of floats in a reference, see LinearisedCost.
  [[nodiscard]] std::size_t reference_size() const { return cost_.reference_size(); }
  /// Writes an initial reference: a weak measurement of all targets in reach of the start.
  void begin(float* reference) const;

  struct Answer {
    double cost = 0.0;     ///< −∞: no bound
    bool expired = false;  ///< the deadline expired
  };
  /// Returns a lower bound of the cost of the steps after `depth` for a robot at `at` with the
  /// belief `blocks`. Also moves `reference` by `share` towards the measurements of the lattice's
  /// best path. The lattice has at most `states` states. Adds its work to `work_nodes`, in nodes.
  Answer cost_to_go(const Pose2& at, int depth, const Blocks& blocks, float* reference,
                    double share, std::size_t states, const Deadline& deadline,
                    std::int64_t& work_nodes);

  /// Marks in `cost` the targets that a robot at `at` can have in range after `depth`.
  void mark_reached(const Pose2& at, int depth, LinearisedCost& cost) const;

  struct Path {
    double gained = 0.0;  ///< upper bound of Σ ⟨G, M⟩, with M capped by saturation; ∞: no bound
    bool expired = false;
  };
  /// Bounds the gain, as linearised by `cost`, of all paths from `at` after `depth`. If
  /// `path_information` is not null, adds the information of the lattice's best path to
  /// `path_information`, which has the size of a reference.
  Path best_path(const Pose2& at, int depth, const LinearisedCost& cost, float* path_information,
                 std::size_t states, const Deadline& deadline, std::int64_t& work_nodes);

 private:
  static constexpr float kNever = -1e30F;  ///< the cell is not reachable
  static constexpr int kPauseStepsMax = 3;
  static constexpr std::size_t kTargetNodes = 200;  ///< nodes per linearised target or step
  static constexpr std::size_t kMovesANode = 150;   ///< moves to a cell that count as one node

  /// Information of a sensor about a planar target.
  struct Sensor {
    double range_max_m = 0.0;
    double range_min_m = 0.0;
    double half_fov_rad = 0.0;
    double along = 0.0;
    double across = 0.0;
    double isotropic_per_m2 = 0.0;
    double growth_per_m = 0.0;
    double variance_floor = 0.0;
    bool grows = false;
  };
  /// Value of measurements of a target at one depth, in the frame of the query pose. Information in
  /// direction θ has the value mean + half_difference cos 2θ + xy sin 2θ.
  struct LocalGradient {
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();  ///< expected target position
    double mean = 0.0;
    double half_difference = 0.0;
    double xy = 0.0;
    double amplitude = 0.0;
    double weight = 0.0;
    double known = 0.0;
    double near_radius_m = 0.0;
  };
  /// Best measurement of one sensor from a cell, and the part of its information that counts
  /// linearly.
  struct CellGain {
    double reward = 0.0;
    double near_gain = 0.0;  ///< additional gain of a measurement from very close, which is rare
    double along = 0.0;
    double across = 0.0;
    double half_angle_rad = 0.0;
  };

  void find_rare_gains();
  bool clear_level(int t);
  bool add_rewards(int t);
  [[nodiscard]] LocalGradient local_gradient(int m, int k) const;
  static CellGain cell_gain(const LocalGradient& local_gradient, const Sensor& sensor, double dx_m,
                            double dy_m, double half_cell_m);
  bool gather(int t);
  /// Computes the best gain after each cell of a row with heading n, if the next `pause_left` steps
  /// have no rare gain.
  void find_successor_maxima(int t, int n, int j, ReachLattice::Row row, int pause_left,
                             float* most) const;
  static void find_square_maxima(const float* here, const ReachLattice::Plane& plane, float* out);
  [[nodiscard]] double best_first_step() const;
  bool follow_best(float* path_information);
  /// Returns the cell that a control leads to from the start.
  [[nodiscard]] ReachLattice::Shift first_cell(std::size_t control) const;
  /// Returns the offset of the gains from level t on with heading n, if the next `pause_left` steps
  /// have no rare gain.
  [[nodiscard]] std::size_t begin_of(int t, int pause_left, int n) const {
    const ReachLattice::Level& level = layout_->levels[index(t)];
    return index(pause_steps_) * level.begin + index(pause_left) * level.size +
           layout_->plane(t, n).begin;
  }
  bool work(std::size_t nodes);

  const SearchProblem* problem_ = nullptr;
  const BeliefTable* beliefs_ = nullptr;
  const Deadline* deadline_ = nullptr;
  std::int64_t* work_nodes_ = nullptr;
  bool applies_ = false;
  int pause_steps_ = 1;  ///< minimum number of steps between rare gains
  int targets_ = 0;
  int horizon_ = 0;
  double sight_m_ = 0.0;
  std::vector<Sensor> sensors_;
  std::vector<models::Rectangle>
      bounding_boxes_;                ///< per target: bounding box of its expected positions
  std::vector<double> near_radii_m_;  ///< per target: distance below which a gain is rare; 0: none
  ReachLattice reach_;

  // State of one query.
  Pose2 from_;
  int depth_ = 0;
  LinearisedCost cost_;                         ///< linearised cost in cost_to_go()
  const LinearisedCost* query_cost_ = nullptr;  ///< the cost used by this query
  const ReachLattice::Layout* layout_ = nullptr;
  std::vector<float> path_information_;  ///< measurements of the best path in cost_to_go()
  ReservedArray<float> states_;          ///< [level][pause_left][heading]: gain from this level on
  ReservedArray<float> squares_;         ///< one level: maximum gain over 2 × 2 cells
  ReservedArray<float> looks_;           ///< one level: gain by heading
  ReservedArray<float> all_round_;       ///< one level: gain independent of the heading
  ReservedArray<float> rare_;            ///< one level: extra gain very close to a target
  std::vector<float> row_;
  std::vector<float> rare_row_;
};

}  // namespace vantage::planner
