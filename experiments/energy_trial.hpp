#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "models/world/world.hpp"
#include "planner/decision/team_oracle.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::experiments {

/// What the text of the dissertation leaves open about its two scenarios.
struct EnergyTrialOptions {
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 1.0;
  double acceleration_q = 0.1;  ///< m²/s³, of the targets
  /// Of the metric in which δ = 2 m is meant: such that N of ten robots comes near the text's
  /// 12500.
  double yaw_weight_m_per_rad = 1.7;
};

/// One draw of a team, its targets and the candidates of each robot.
struct EnergyTrial {
  std::unique_ptr<models::World> world;        ///< that the robots' problems point to
  std::vector<planner::SearchProblem> robots;  ///< what each robot's candidates solve
  std::vector<planner::EnergyModel> energy;    ///< of each robot
  planner::TeamProblem team;
};

/// Scenario 1, "multi-robot dynamic target tracking": n ground robots and as many targets in a
/// square of 40 m (n = 2) to 60 m (n = 10), the i-th robot i times as dear to move as the first.
/// Where robots and targets are is drawn by `seed` and `n` alone: the same on every machine.
/// Source: dissertation 3 D.2, Table 3.1.
EnergyTrial draw_energy_trial(int n, std::uint64_t seed, const EnergyTrialOptions& options,
                              planner::ReducedValueIteration& search);

/// Scenario 2, "heterogeneous sensing and control": two ground robots, then one that flies, and ten
/// static targets in a square of 100 m with mud and wind. Robots begin outside both.
/// Source: dissertation 3 D.3, Table 3.1.
struct HeterogeneousTrialOptions {
  double price_nats = 0.0;  ///< r, of every robot
  int horizon_steps = 20;
  EnergyTrialOptions open;
};
EnergyTrial draw_heterogeneous_trial(std::uint64_t seed, const HeterogeneousTrialOptions& options,
                                     planner::ReducedValueIteration& search);

/// The arena of scenario 2: its mud and its wind, which overlap.
models::World heterogeneous_world();

/// `team` with the best `share` of each robot's candidates by value alone, at least one each.
planner::TeamProblem best_share(const planner::TeamOracle& oracle, double share);

}  // namespace vantage::experiments
