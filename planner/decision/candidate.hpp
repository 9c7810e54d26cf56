#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/deadline.hpp"
#include "planner/decision/target_courses.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/arvi.hpp"
#include "scenario/energy_spec.hpp"

namespace vantage::planner {

/// A trajectory that a robot may be given, as far as the team's choice is concerned.
struct Candidate {
  std::vector<int> controls;  ///< indices into its SearchProblem::controls, one a step
  std::vector<Pose2> poses;   ///< at each step's end
  std::vector<Look> looks;    ///< by target, then step; only those that see something
  double energy_cost = 0.0;   ///< r_i C_i ≥ 0, nats
  /// What it gains of things that only its own robot knows of, ≥ 0, nats: counted whole.
  double unshared_nats = 0.0;
  /// I(y_{1:T}; z_{1:T}) of these looks alone at the targets it was made for, nats, where that came
  /// with its making: a TeamOracle of the same targets need not ask for it. Who changes the looks
  /// or the targets clears it.
  std::optional<double> mutual_nats = std::nullopt;
};

using EnergyModel = scenario::EnergySpec;

/// C_i of `controls` from the problem's start through `poses`, without its price. The state of each
/// step is where the step begins. Precondition: as many poses as controls.
double energy_used(const EnergyModel& energy, const SearchProblem& problem,
                   const std::vector<int>& controls, const std::vector<Pose2>& poses);

/// The candidate of `controls`: its poses, looks about the targets' predicted means, its cost.
Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         std::vector<int> controls);

/// The candidate that a search's plan is, its hover at the end included.
Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         const SearchResult& result);

/// The candidate that a teammate's `trajectory` is to the beliefs of `problem`, seen through
/// `sensor`; nullptr: a robot that sees nothing.
Candidate make_candidate(const SearchProblem& problem, const models::SensorModel* sensor,
                         const models::Trajectory& trajectory, double energy_cost);

/// How the candidate trajectories of a robot are found.
struct CandidateOptions {
  double epsilon = 1.0;  ///< of the reduced value iteration's one pass
  double delta_m = 2.0;
  double yaw_weight_m_per_rad = 0.3;
  /// Anytime passes from (ε, δ) on instead of one, and the leaves by ascending ½ J_T plus the cost
  /// of their energy instead of J_T: a set that is good whenever the deadline comes.
  bool is_anytime = false;
  std::size_t leaves_max = kNoLimit;      ///< that are looked at, in that order
  std::size_t candidates_max = kNoLimit;  ///< that are kept

  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
};

/// The complete trajectories that reduced value iteration leaves, in the order of its tree; those
/// that cannot stop where a stop is demanded are left out. The last depth is reduced as all others
/// are: of leaves that δ-cross and are ε-redundant the cheaper one stays, so the best plan of the
/// search always does. Whether leaves are redundant shows when each is followed to its end, and so
/// does what it gains (mutual_nats, unless teammates' looks are fixed). `search` must be large
/// enough for `problem`: a pass that was cut short gives what it reached. The deadline is the
/// search's; what follows takes at most leaves_max times the targets and steps.
/// @throws UsageError as ReducedValueIteration::plan does, or when ε or δ is not finite
/// Source: dissertation 3 D (Mᵢ from reduced value iteration).
std::vector<Candidate> candidate_trajectories(const SearchProblem& problem,
                                              const EnergyModel& energy,
                                              ReducedValueIteration& search,
                                              const CandidateOptions& options,
                                              const Deadline& deadline = Deadline::never());

}  // namespace vantage::planner
