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

namespace vantage::planner {

/// Of one problem, at most.
inline constexpr int kMaxControls = 64;

enum class CostKind {
  kLogDet,  ///< J_T = Σ_t Σ_m log det Σ_{m,t}, nats
  kTrace,   ///< J_T = Σ_t Σ_m tr Σ_{m,t}
};

/// One independent target (or exploration landmark) as it is believed to be at the plan's start.
struct SearchTarget {
  models::TargetModel model;
  models::Gaussian prior;
};

/// One robot's planning problem: choose `horizon_steps` controls, each held for `step_s`, that
/// minimise the summed cost of the beliefs; at each step every block is predicted, then updated by
/// what the sensors see from the new pose about the target's predicted mean.
/// Source: dissertation eq. 2.10 (Problem 2), with the sum over t = 1 … T.
struct SearchProblem {
  Time start_time{};
  Pose2 start;  ///< world from body
  double height_m = 0.0;
  std::vector<models::UnicycleControl> controls;
  int horizon_steps = 12;
  double step_s = 0.5;
  std::vector<models::SensorModel> sensors;  ///< all carried by the robot; their information adds
  std::vector<SearchTarget> targets;
  CostKind cost = CostKind::kLogDet;

  /// Information that teammates' fixed plans will have given of target m by arrival at depth t:
  /// fixed_information[m][t − 1], position_dim square. Empty: none.
  std::vector<std::vector<models::PositionMatrix>> fixed_information;

  const models::World* world = nullptr;          ///< null: unbounded and empty
  const models::DistanceField* field = nullptr;  ///< of `world`; null: slower, same answers
  double clearance_m = 0.0;                      ///< the disc around the robot that must be free
  bool obstacles_block_sight = true;             ///< false: sensors see over or through them

  /// Teammates' committed motion, to be kept at `separation_m` in space, or whatever their heights;
  /// kept_separation_m() says what that means for a robot that starts nearer.
  std::vector<models::Trajectory> teammates;
  double separation_m = 0.0;
  bool separation_from_above = false;
  /// Deceleration of the stop that must be possible, clear and apart at the end; 0: none demanded.
  double brake_mps2 = 0.0;
  double start_speed_mps = 0.0;  ///< at `start`, for the stop of a plan that moves no more
  std::uint64_t seed = 0;        ///< of searches that draw
};

/// What stands between sensors and targets: the world, or null.
inline const models::World* sight_world(const SearchProblem& problem) {
  return problem.obstacles_block_sight ? problem.world : nullptr;
}

/// The height at which a plan keeps from a teammate: the teammate's or, seen from above, its own.
inline double kept_height_m(const SearchProblem& problem, const models::Trajectory& teammate) {
  return problem.separation_from_above ? problem.height_m : teammate.height_m;
}

/// What a plan keeps from teammate i: `separation_m` or, if it is nearer when the plan starts, that
/// distance less a centimetre. Whoever has come too near may leave, and comes no nearer.
double kept_separation_m(const SearchProblem& problem, std::size_t i);
/// The same of any two motions that begin when the plan does.
double kept_separation_m(const SearchProblem& problem, const models::Trajectory& own,
                         const models::Trajectory& other);

/// Throws UsageError naming the rule that `problem` breaks: sizes, finite numbers, positive steps,
/// forward controls, definite symmetric priors, information for every step. A search checks this
/// once when it is given a problem. Allocates nothing unless it throws.
void require_valid(const SearchProblem& problem);

/// Why a search ended.
enum class StopReason {
  kFinished,   ///< nothing left to do: the result is optimal over the controls
  kDeadline,   ///< time or nodes were used up
  kMemory,     ///< the arena is full
  kConverged,  ///< the asked (ε, δ) pass is done
};

/// What was known when one pass of an anytime search ended.
struct PassReport {
  double epsilon = 0.0;
  double delta_m = 0.0;
  double cost = 0.0;
  std::int64_t work_nodes = 0;
};

/// The best complete plan that a search found.
struct SearchResult {
  bool found = false;         ///< false only when nothing at all is feasible
  std::vector<int> controls;  ///< indices into SearchProblem::controls, one a step
  std::vector<Pose2> poses;   ///< at each step's end, as many
  double cost = 0.0;          ///< J_T
  /// Leading steps taken from `controls`; fewer than the horizon when no complete sequence was
  /// feasible and the robot stops and hovers from there on (controls then has just these).
  int moving_steps = 0;
  double lower_bound = 0.0;  ///< proven, ≤ the optimum; −∞ when none is
  double epsilon = 0.0;      ///< of the last finished pass
  double delta_m = 0.0;
  std::int64_t passes = 0;  ///< finished
  std::int64_t nodes_generated = 0;
  std::int64_t nodes_expanded = 0;
  std::int64_t work_nodes = 0;  ///< generated + considered + compared: the unit of node budgets
  std::size_t peak_bytes = 0;   ///< of nodes, blocks and lists: what the search has touched
  StopReason stop_reason = StopReason::kFinished;
  std::vector<PassReport> history;  ///< one entry a finished pass, in order

  /// As before a search: nothing found, nothing proven, nothing counted. What vectors have reserved
  /// they keep.
  void reset();

  /// The node budget under which the same search ends at the same place.
  [[nodiscard]] std::int64_t replay_budget_nodes() const {
    return stop_reason == StopReason::kDeadline ? work_nodes : work_nodes + 1;
  }
};

/// The motion that `result` stands for: its primitives, the stop, the hover.
models::Trajectory to_trajectory(const SearchProblem& problem, const SearchResult& result);
models::Trajectory to_trajectory(const SearchProblem& problem, std::span<const int> controls);

/// J_T of being at `poses` (one a step) by the plain recursion of models/belief: the scorer that
/// searches are tested against. O(T·M).
double score(const SearchProblem& problem, const std::vector<Pose2>& poses);

}  // namespace vantage::planner
