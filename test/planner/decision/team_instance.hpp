#pragma once

#include <cstdint>
#include <vector>

#include "planner/decision/team_oracle.hpp"

namespace vantage::test {

/// The size and kind of a random team problem.
struct InstanceLimits {
  int robots_max = 4;
  int candidates_max = 4;   ///< per robot; some robots have none
  double cost_max = 0.0;    ///< nats; 0: trajectories have no cost
  int candidates_all = 99;  ///< sum over the team
};

/// Returns a small team problem drawn by `seed`. Targets are planar, spatial or moving, and
/// measurements have any rank. Some candidates have no measurements, and some are equal.
planner::TeamProblem random_instance(std::uint64_t seed, const InstanceLimits& limits,
                                     planner::InformationMeasure measure);

/// Returns J of any set of candidates (several per robot are allowed), computed by the recursion of
/// models/belief from the first step. It is the reference for all faster computations.
double plain_value(const planner::TeamProblem& problem,
                   const std::vector<const planner::Candidate*>& chosen);

/// Returns the candidates of `choice`.
std::vector<const planner::Candidate*> chosen_of(const planner::TeamOracle& oracle,
                                                 const planner::Choice& choice);

/// Returns random candidates; some robots have none.
planner::Choice random_choice(const planner::TeamOracle& oracle, std::uint64_t seed);

/// Calls look(seed, problem, oracle) for the instances of the first `count` seeds.
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
