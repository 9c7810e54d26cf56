#include "planner/decision/team_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

// Returns the part of a team's problem needed to predict its targets.
SearchProblem prediction_of(const TeamProblem& problem) {
  SearchProblem prediction;
  prediction.controls = {{0.0, 0.0}};
  prediction.horizon_steps = problem.horizon_steps;
  prediction.step_s = problem.step_s;
  prediction.targets = problem.targets;
  prediction.cost = CostKind::kLogDet;
  require_valid(prediction);
  return prediction;
}

}  // namespace

TeamOracle::TeamOracle(const TeamProblem& problem)
    : problem_(&problem), courses_(prediction_of(problem), problem.measure) {
  begin_.push_back(0);
  for (std::size_t robot = 0; robot < problem.candidates.size(); ++robot) {
    double greatest_cost = 0.0;
    for (const Candidate& candidate : problem.candidates[robot]) {
      candidates_.push_back(&candidate);
      robot_of_.push_back(static_cast<int>(robot));
      greatest_cost = std::max(greatest_cost, candidate.energy_cost);
    }
    begin_.push_back(static_cast<CandidateId>(candidates_.size()));
    offset_ += greatest_cost;
  }
  check();
  TeamSet empty_set(*this);
  by_value_.resize(candidates_.size());
  std::iota(by_value_.begin(), by_value_.end(), 0);
  for (const CandidateId id : by_value_) {
    const Candidate& of = candidate(id);
    individual_values_.push_back(of.mutual_nats && is_submodular()
                                     ? *of.mutual_nats + (of.unshared_nats - of.energy_cost)
                                     : empty_set.value_with(id));
  }
  calls_ = empty_set.calls();
  for (int robot = 0; robot < robot_count(); ++robot) {
    std::stable_sort(
        by_value_.begin() + begin(robot), by_value_.begin() + end(robot),
        [this](CandidateId a, CandidateId b) { return individual_value(a) > individual_value(b); });
  }
}

void TeamOracle::check() const {
  for (const Candidate* candidate : candidates_) {
    require(candidate->energy_cost >= 0.0 && std::isfinite(candidate->energy_cost),
            "team: a candidate's energy_cost must be ≥ 0");
    require(candidate->unshared_nats >= 0.0 && std::isfinite(candidate->unshared_nats),
            "team: a candidate's unshared_nats must be ≥ 0");
    constexpr double kRounding = 1e-9;
    require(!candidate->mutual_nats ||
                (*candidate->mutual_nats >= -kRounding && std::isfinite(*candidate->mutual_nats)),
            "team: a candidate's mutual_nats must be ≥ 0");
    const PredictedMeasurement* last = nullptr;
    for (const PredictedMeasurement& measurement : candidate->measurements) {
      require(measurement.target < target_count() && measurement.step >= 1 &&
                  measurement.step <= problem_->horizon_steps,
              "team: each measurement must have a target of the problem and a step of the horizon");
      require(last == nullptr || last->target < measurement.target ||
                  (last->target == measurement.target && last->step < measurement.step),
              "team: measurements must be ordered by target, then by step");
      last = &measurement;
    }
  }
}

std::span<const CandidateId> TeamOracle::by_value(int robot) const {
  return {by_value_.data() + begin(robot), index(end(robot) - begin(robot))};
}

}  // namespace vantage::planner
