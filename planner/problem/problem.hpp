#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/motion/unicycle.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "models/plan/plan.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/grid.hpp"
#include "models/world/world.hpp"
#include "planner/problem/terminal_value.hpp"

namespace vantage::planner {

/// Maximum number of controls of one problem.
inline constexpr int kMaxControls = 64;

enum class CostKind {
  kLogDet,  ///< J_T = Σ_t Σ_m log det Σ_{m,t}, nats
  kTrace,   ///< J_T = Σ_t Σ_m tr Σ_{m,t}
};

/// One independent target (or exploration landmark) and its belief at the plan's start.
struct SearchTarget {
  models::TargetModel model;
  models::Gaussian prior;
};

/// One robot's planning problem: choose `horizon_steps` controls, each held for `step_s`, that
/// minimise the summed cost of the beliefs. At each step every block is predicted and then updated
/// with the sensors' information at the new pose about the target's predicted mean. For sensors
/// that measure velocity, a target without velocity in its state is stationary.
/// Source: dissertation eq. 2.10 (Problem 2), with the sum over t = 1 … T.
struct SearchProblem {
  Time start_time{};
  Pose2 start;  ///< world from body
  double height_m = 0.0;
  std::vector<models::UnicycleControl> controls;
  int horizon_steps = 12;
  double step_s = 0.5;
  std::vector<models::SensorModel> sensors;  ///< all sensors on this robot; information adds up
  std::vector<SearchTarget> targets;
  CostKind cost = CostKind::kLogDet;

  /// Information of the teammates' fixed plans about target m on arrival at depth t:
  /// fixed_information[m][t − 1], a matrix of size position_dim (about the position) or dim (about
  /// the state). Empty if there is none.
  std::vector<std::vector<models::StateMatrix>> fixed_information;

  /// Terminal value, which is added to J_T of every complete plan; empty: nothing is added. A
  /// target counts as measured if a sensor of this robot gives information about it at a step
  /// before the last.
  TerminalValue terminal;

  const models::World* world = nullptr;  ///< null: unbounded and empty
  /// distance field of `world`; null: the results are the same, but the search is slower
  const models::DistanceField* field = nullptr;
  /// m; radius of the disc around the robot that must be free of obstacles
  double clearance_m = 0.0;
  bool obstacles_block_sight = true;  ///< false: sensors see over or through obstacles

  /// Committed motion of the teammates. The plan keeps `separation_m` from it in space, or in the
  /// plane if `separation_from_above`. See required_separation_m() for a robot that starts closer.
  std::vector<models::Trajectory> teammates;
  double separation_m = 0.0;
  bool separation_from_above = false;
  /// Deceleration of the stop that must be collision-free at the plan's end, m/s²; 0: no stop
  /// required.
  double brake_mps2 = 0.0;
  double start_speed_mps = 0.0;  ///< speed at `start`, for the stop of a plan without motion
  std::uint64_t seed = 0;        ///< random seed of randomised searches
};

/// Returns the world that blocks sight between sensors and targets, or null.
inline const models::World* sight_world(const SearchProblem& problem) {
  return problem.obstacles_block_sight ? problem.world : nullptr;
}

/// Returns the height used for the distance to a teammate: the teammate's, or the robot's own if
/// `separation_from_above`.
inline double separation_height_m(const SearchProblem& problem,
                                  const models::Trajectory& teammate) {
  return problem.separation_from_above ? problem.height_m : teammate.height_m;
}

/// Returns the distance that a plan must keep from teammate i: `separation_m`, or the distance at
/// the plan's start minus 1 cm if that is smaller. A robot that is too close may thus move away,
/// but not closer.
double required_separation_m(const SearchProblem& problem, std::size_t i);
/// As above, for any two motions that begin at the plan's start.
double required_separation_m(const SearchProblem& problem, const models::Trajectory& own,
                             const models::Trajectory& other);

/// Throws UsageError with the violated rule. Rules: matching sizes, finite numbers, positive steps,
/// forward controls, symmetric positive definite priors, information for every step. A search calls
/// this once per problem. Allocates nothing unless it throws.
void require_valid(const SearchProblem& problem);

/// Reason why a search ended.
enum class StopReason {
  kFinished,  ///< the search is complete: its result is optimal among all sequences of the controls
  kDeadline,  ///< time or nodes were used up
  kMemory,    ///< the arena is full
  kConverged,  ///< the requested (ε, δ) pass is complete
};

/// State of an anytime search at the end of one pass.
struct PassReport {
  double epsilon = 0.0;
  double delta_m = 0.0;
  double cost = 0.0;
  std::int64_t work_nodes = 0;
};

/// The best complete plan that a search found.
struct SearchResult {
  bool found = false;         ///< false only if no plan at all is feasible
  std::vector<int> controls;  ///< indices into SearchProblem::controls, one per step
  std::vector<Pose2> poses;   ///< pose at the end of each step of the horizon
  double cost = 0.0;          ///< J_T plus the terminal value, if the problem has one
  /// Number of leading steps taken from `controls`. It is less than the horizon if no complete
  /// sequence was feasible; `controls` then has only these steps. After them the robot stops and
  /// hovers.
  int moving_steps = 0;
  double lower_bound = 0.0;  ///< proven lower bound of the optimum; −∞ if none is proven
  /// True if `cost` and `lower_bound` include the problem's terminal value.
  bool has_terminal_value = false;
  double epsilon = 0.0;  ///< ε of the last completed pass
  double delta_m = 0.0;
  std::int64_t passes = 0;  ///< completed passes
  std::int64_t nodes_generated = 0;
  std::int64_t nodes_expanded = 0;
  std::int64_t work_nodes = 0;  ///< generated + considered + compared: unit of node budgets
  std::size_t peak_bytes = 0;   ///< peak of nodes, blocks and lists in use
  StopReason stop_reason = StopReason::kFinished;
  std::vector<PassReport> history;  ///< one entry per completed pass, in order

  /// Resets the result to its state before a search. Vectors keep their capacity.
  void reset();

  /// Returns the node budget that stops the same search at the same node.
  [[nodiscard]] std::int64_t replay_budget_nodes() const {
    return stop_reason == StopReason::kDeadline ? work_nodes : work_nodes + 1;
  }
};

/// Returns the motion of `result`: its primitives, then the stop, then the hover.
models::Trajectory to_trajectory(const SearchProblem& problem, const SearchResult& result);
models::Trajectory to_trajectory(const SearchProblem& problem, std::span<const int> controls);

/// Returns J_T plus the terminal value for `poses` (one per step) by the plain recursion of
/// models/belief: reference for tests of the searches. O(T·M).
double score(const SearchProblem& problem, const std::vector<Pose2>& poses);

/// Returns the terminal value of `poses` (one per step); 0 if the problem has none. O(T·M).
double terminal_cost(const SearchProblem& problem, const std::vector<Pose2>& poses);

}  // namespace vantage::planner
