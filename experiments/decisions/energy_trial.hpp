#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "models/world/world.hpp"
#include "planner/decision/team_oracle.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::experiments {

/// Parameters that the dissertation does not state, for both scenarios.
struct EnergyTrialOptions {
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 1.0;
  double acceleration_q = 0.1;  ///< m²/s³; acceleration noise density of the targets
  /// m/rad; weight of the yaw in the metric of δ = 2 m. Chosen such that N, the number of
  /// candidates of ten robots, is near the dissertation's 12500.
  double yaw_weight_m_per_rad = 1.7;
};

/// One randomly drawn team with its targets and the candidates of each robot.
struct EnergyTrial {
  std::unique_ptr<models::World> world;        ///< referenced by the robots' problems
  std::vector<planner::SearchProblem> robots;  ///< by robot: the problem that its candidates solve
  std::vector<planner::EnergyModel> energy;    ///< energy model, by robot
  planner::TeamProblem team;
};

/// Draws a trial of scenario 1, "multi-robot dynamic target tracking": n ground robots and n
/// targets in a square of 40 m (n = 2) to 60 m (n = 10). The motion cost of the i-th robot is i
/// times that of the first. `seed` and `n` alone determine the positions of robots and targets, on
/// every machine.
/// Source: dissertation, section 3.D.2, Table 3.1.
EnergyTrial draw_energy_trial(int n, std::uint64_t seed, const EnergyTrialOptions& options,
                              planner::ReducedValueIteration& search);

/// Options of scenario 2, "heterogeneous sensing and control": two ground robots, one flying robot,
/// and ten static targets in a square of 100 m with mud and wind. Robots start outside both
/// regions.
/// Source: dissertation, section 3.D.3, Table 3.1.
struct HeterogeneousTrialOptions {
  double price_nats = 0.0;  ///< energy price r of every robot
  int horizon_steps = 20;
  EnergyTrialOptions open;
};
EnergyTrial draw_heterogeneous_trial(std::uint64_t seed, const HeterogeneousTrialOptions& options,
                                     planner::ReducedValueIteration& search);

/// Returns the world of scenario 2 with its regions of mud and wind, which overlap.
models::World heterogeneous_world();

/// Returns the team problem with only the best `share` of each robot's candidates by individual
/// value; at least one candidate per robot.
planner::TeamProblem best_share(const planner::TeamOracle& oracle, double share);

}  // namespace vantage::experiments
