#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::planner {

/// An attack: the robots that lose their sensors, and the value of the team without them. Attacked
/// robots still move and communicate.
struct Attack {
  std::vector<int> robots;  ///< indices of the attacked robots, ascending
  double value = 0.0;       ///< J of the other robots' trajectories, nats
  std::int64_t oracle_calls = 0;
};

/// Returns the attack on at most `attacks_max` robots that leaves `choice` the smallest value, by
/// enumeration. Of equal attacks, prefers the one on fewer robots, then on lower numbers. Cost:
/// Σ_{k≤α} C(n, k) oracle calls.
Attack worst_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// Returns the greedy worst-case attack: repeatedly removes the robot without which the remaining
/// value is smallest, as long as the value decreases. The experiments use this attack as "worst
/// case". Cost: O(n α) oracle calls. Source: dissertation, section 4.F (greedy approximation of the
/// worst case).
Attack greedy_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// Returns the attack on the `attacks_max` robots with the trajectories of greatest individual
/// value. Of robots with equal values, those with lower numbers are attacked. Robust trajectory
/// planning selects its bait by the same criterion, which ignores overlap with other robots. Cost:
/// α oracle calls.
Attack attack_on_best_alone(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// Returns the attack on the robots with the trajectories of greatest joint value, selected
/// greedily: starting from the empty set, each step adds the robot that maximises J(A) of the
/// attacked set A, until A has `attacks_max` robots or contains all robots. Of equally good robots
/// it adds the one with the lower number. With one attack it equals attack_on_best_alone(). Cost:
/// O(n α) oracle calls.
Attack attack_on_best_together(const TeamOracle& oracle, const Choice& choice, int attacks_max);

/// Attacker model; every attacker knows the team's plans.
enum class Attacker {
  kGreedy,        ///< greedy_attack
  kBestAlone,     ///< attack_on_best_alone
  kBestTogether,  ///< attack_on_best_together
};

Attack attack_by(Attacker attacker, const TeamOracle& oracle, const Choice& choice,
                 int attacks_max);

/// Draws `attacks` different robots out of `robot_count`, in ascending order; every set is equally
/// likely. The result is the same on every machine. Precondition: 0 ≤ attacks ≤ robot_count.
std::vector<int> random_attack(int robot_count, int attacks, std::mt19937_64& rng);

}  // namespace vantage::planner
