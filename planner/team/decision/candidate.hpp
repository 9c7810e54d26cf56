#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planner/search/arvi.hpp"
#include "planner/search/block_kernels.hpp"
#include "planner/search/problem.hpp"

namespace vantage::planner {

/// What one look along a trajectory tells of one target.
struct Look {
  std::uint16_t target = 0;
  std::uint16_t step = 0;  ///< 1 … T: on arrival there
  PackedInformation information;
};

/// A trajectory that a robot may be given, as far as the team's choice is concerned.
struct Candidate {
  std::vector<int> controls;  ///< indices into its SearchProblem::controls, one a step
  std::vector<Pose2> poses;   ///< at each step's end
  std::vector<Look> looks;    ///< by target, then step; only those that see something
  double energy_cost = 0.0;   ///< r_i C_i ≥ 0, nats
};

/// What moving costs a robot, C_i = Σ_{t=0}^{T−1} (c_ctrl(u_t) + c_state(x_t)), and its price.
/// Source: dissertation eq. 3.14, 3.19, Table 3.1.
struct EnergyModel {
  double price_nats = 0.0;           ///< r_i: nats of information that one unit of cost is worth
  double rest_cost = 0.0;            ///< a step with neither speed nor yaw rate
  double turn_cost = 0.0;            ///< a step with a yaw rate alone
  double move_cost = 0.0;            ///< any step with a speed
  std::vector<std::string> regions;  ///< names of the world's regions whose cost_per_step it pays
};

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

/// How the candidate trajectories of a robot are found.
struct CandidateOptions {
  double epsilon = 1.0;  ///< of the reduced value iteration's one pass
  double delta_m = 2.0;
  double yaw_weight_m_per_rad = 0.3;
};

/// The complete trajectories that one pass of reduced value iteration leaves, in the order of its
/// tree; those that cannot stop where a stop is demanded are left out. The last depth is reduced as
/// all others are: of leaves that δ-cross and are ε-redundant the cheaper one stays, so the best
/// plan of the search always does. `search` must be large enough for `problem`: a pass that was cut
/// short gives what it reached.
/// @throws UsageError as ReducedValueIteration::plan does, or when ε or δ is not finite
/// Source: dissertation 3 D (Mᵢ from reduced value iteration).
std::vector<Candidate> candidate_trajectories(const SearchProblem& problem,
                                              const EnergyModel& energy,
                                              ReducedValueIteration& search,
                                              const CandidateOptions& options);

}  // namespace vantage::planner
