#pragma once

#include <cstdint>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::test {

/// How large and what kind a random team problem is.
struct InstanceLimits {
  int robots_max = 4;
  int candidates_max = 4;   ///< of one robot; some have none
  double cost_max = 0.0;    ///< nats; 0: trajectories cost nothing
  int candidates_all = 99;  ///< of the whole team
};

/// A small team problem drawn by `seed`: planar, spatial and moving targets, looks of any rank,
/// some candidates that see nothing, some that are equal.
planner::TeamProblem random_instance(std::uint64_t seed, const InstanceLimits& limits,
                                     planner::InformationMeasure measure);

/// J of any set of candidates, several of one robot among them, by the plain recursion of
/// models/belief from the first step on: what everything else is held against.
double plain_value(const planner::TeamProblem& problem,
                   const std::vector<const planner::Candidate*>& chosen);

/// The candidates that `choice` has.
std::vector<const planner::Candidate*> chosen_of(const planner::TeamOracle& oracle,
                                                 const planner::Choice& choice);

/// A choice of random candidates, some robots with none.
planner::Choice random_choice(const planner::TeamOracle& oracle, std::uint64_t seed);

/// Calls look(seed, problem, oracle) of the instances of the first `count` seeds.
template <class Look>
void for_each_instance(std::uint64_t count, const InstanceLimits& limits,
                       planner::InformationMeasure measure, const Look& look) {
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const planner::TeamProblem problem = random_instance(seed, limits, measure);
    const planner::TeamOracle oracle(problem);
    look(seed, problem, oracle);
  }
}

}  // namespace vantage::test
