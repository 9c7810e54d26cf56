#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// Robots whose sensors see nothing, and what is left to the team. They still move and talk.
struct Attack {
  std::vector<int> robots;  ///< ascending
  double value = 0.0;       ///< J of the others' trajectories, nats
  std::int64_t oracle_calls = 0;
};

/// The attack on at most `attacks_max` robots that leaves `choice` the least, by enumeration; of
/// equals the one on the fewest, lowest robots. Cost: Σ_{k≤α} C(n, k) oracle calls.
Attack worst_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// The same one robot at a time, each time the one without which the team is left least, while
/// that takes something away: what the experiments call worst case. Cost: O(n α) oracle calls.
/// Source: dissertation 4 F (greedy approximation of the worst case).
Attack greedy_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// The attack on the `attacks_max` robots whose trajectories alone are worth most; of equals the
/// lower numbers. It is the one that RTP's bait is laid for, and takes no account of what others
/// see as well. Cost: α oracle calls.
Attack attack_on_best_alone(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// The attack on robots whose trajectories together are worth most, forward-greedily: from nobody
/// on, each time the robot with which J(A) of those taken is largest, until there are `attacks_max`
/// or nobody is left; of equals the lower number. For one attack it is attack_on_best_alone().
/// Cost: O(n α) oracle calls.
Attack attack_on_best_together(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// Who takes sensors, knowing the team's plans.
enum class Attacker {
  kGreedy,        ///< greedy_attack
  kBestAlone,     ///< attack_on_best_alone
  kBestTogether,  ///< attack_on_best_together
};

Attack attack_by(Attacker attacker, const TeamOracle& oracle, const Choice& choice,
                 int attacks_max);

/// `attacks` different robots of `robot_count`, every such set equally likely; ascending. The
/// same on every machine. Precondition: 0 ≤ attacks ≤ robot_count.
std::vector<int> random_attack(int robot_count, int attacks, std::mt19937_64& rng);

/// One line of a script: these robots, from step `begin` up to but not including `end`.
struct AttackInterval {
  std::int64_t begin_step = 0;
  std::int64_t end_step = 0;
  std::vector<int> robots;
};

/// Robots attacked at `step` by any interval of `script`, ascending, each once.
std::vector<int> scripted_attack(const std::vector<AttackInterval>& script, std::int64_t step);

}  // namespace vantage::planner
