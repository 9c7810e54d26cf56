#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "planner/decision/team_set.hpp"

namespace vantage::test {

inline constexpr planner::InformationMeasure kMeasures[] = {planner::InformationMeasure::kMutual,
                                                            planner::InformationMeasure::kLogDet};

inline std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Returns J of `choice`, computed with a new set.
inline double value_of(const planner::TeamOracle& oracle, const planner::Choice& choice) {
  planner::TeamSet team(oracle);
  team.become(choice);
  return team.value();
}

/// Returns `choice` after candidate `id` is added and the candidate of robot `dropped` is removed.
inline planner::Choice changed(const planner::TeamOracle& oracle, planner::Choice choice,
                               int dropped, planner::CandidateId id) {
  if (dropped >= 0) {
    choice[at(dropped)] = planner::kNoCandidate;
  }
  if (id != planner::kNoCandidate) {
    choice[at(oracle.robot_of(id))] = id;
  }
  return choice;
}

/// A candidate that measures one static target with information `nats`. Candidates of one target
/// gain less than the sum of their information.
struct Made {
  int target = 0;
  double nats = 0.0;
  double cost = 0.0;
};
inline planner::TeamProblem made_team(int targets, const std::vector<std::vector<Made>>& robots) {
  planner::TeamProblem problem;
  problem.horizon_steps = 1;
  for (int m = 0; m < targets; ++m) {
    problem.targets.push_back(
        {{models::TargetKind::kStatic, 2, 0.0},
         {models::StateVector::Zero(2), models::StateMatrix::Identity(2, 2)}});
  }
  for (const std::vector<Made>& of_robot : robots) {
    problem.candidates.emplace_back();
    for (const Made& made : of_robot) {
      // ½ log det (I + M) is log(1 + m) if M = m I.
      const double m = std::expm1(made.nats);
      planner::Candidate candidate;
      candidate.energy_cost = made.cost;
      candidate.measurements = {{static_cast<std::uint16_t>(made.target), 1, {{m, 0.0, m}}}};
      problem.candidates.back().push_back(candidate);
    }
  }
  return problem;
}

}  // namespace vantage::test
