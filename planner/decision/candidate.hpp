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

/// A trajectory that a team decision may assign to a robot.
struct Candidate {
  std::vector<int> controls;  ///< indices into the robot's SearchProblem::controls, one per step
  std::vector<Pose2> poses;   ///< poses at the end of each step
  std::vector<PredictedMeasurement>
      measurements;          ///< sorted by target, then step; only those with nonzero information
  double energy_cost = 0.0;  ///< r_i C_i ≥ 0, nats
  /// Information gain about targets that only this robot knows, ≥ 0, nats. This gain is added to J
  /// without reduction.
  double unshared_nats = 0.0;
  /// I(y_{1:T}; z_{1:T}) of these measurements alone about the targets for which they were
  /// computed, nats, if known. A TeamOracle of the same targets then does not evaluate it. Code
  /// that changes the measurements or the targets must clear it.
  std::optional<double> mutual_nats = std::nullopt;
};

using EnergyModel = scenario::EnergySpec;

/// Returns the energy C_i of `controls` from the problem's start through `poses`, not multiplied by
/// the price. The cost of each step depends on its start position. Precondition: equal numbers of
/// poses and controls.
double energy_used(const EnergyModel& energy, const SearchProblem& problem,
                   const std::vector<int>& controls, const std::vector<Pose2>& poses);

/// Returns the candidate of `controls`: its poses, measurements of the targets' predicted means,
/// and cost.
Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         std::vector<int> controls);

/// Returns the candidate of a search's plan, including the hover at its end.
Candidate make_candidate(const SearchProblem& problem, const EnergyModel& energy,
                         const SearchResult& result);

/// Returns the candidate of a teammate's `trajectory`, evaluated with `sensor` on the beliefs of
/// `problem`; nullptr: the robot has no sensing.
Candidate make_candidate(const SearchProblem& problem, const models::SensorModel* sensor,
                         const models::Trajectory& trajectory, double energy_cost);

/// Options of the search for a robot's candidate trajectories.
struct CandidateOptions {
  double epsilon = 1.0;  ///< ε of the single pass of reduced value iteration
  double delta_m = 2.0;
  double yaw_weight_m_per_rad = 0.3;
  /// True: anytime passes starting at (ε, δ) instead of one pass, and leaves ordered by ½ J_T plus
  /// energy cost instead of J_T. Usable candidates then exist whenever the deadline expires.
  bool is_anytime = false;
  /// maximum number of leaves examined, in the order described above
  std::size_t leaves_max = kNoLimit;
  std::size_t candidates_max = kNoLimit;  ///< maximum number of candidates kept

  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
};

/// Returns the complete trajectories that reduced value iteration leaves, in the order of its tree.
/// Trajectories that cannot stop where a stop is required are omitted. The last depth is reduced
/// like the others: of leaves within δ of each other that are ε-redundant, only the cheapest is
/// kept. The best plan of the search is therefore always kept. Each leaf is evaluated to its end.
/// The final beliefs decide redundancy, and the evaluation sets the gain (mutual_nats, unless
/// teammates' information is fixed). `search` must be large enough for `problem`: a pass that is
/// cut short gives only the leaves reached. The deadline applies to the search; the evaluation
/// after it is O(leaves_max · targets · steps).
/// @throws UsageError as ReducedValueIteration::plan does, or when ε or δ is not finite
/// Source: dissertation, section 3.D (Mᵢ from reduced value iteration).
std::vector<Candidate> candidate_trajectories(const SearchProblem& problem,
                                              const EnergyModel& energy,
                                              ReducedValueIteration& search,
                                              const CandidateOptions& options,
                                              const Deadline& deadline = Deadline::never());

}  // namespace vantage::planner
