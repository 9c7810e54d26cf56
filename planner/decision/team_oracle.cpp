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
    double dearest = 0.0;
    for (const Candidate& candidate : problem.candidates[robot]) {
      candidates_.push_back(&candidate);
      robot_of_.push_back(static_cast<int>(robot));
      dearest = std::max(dearest, candidate.energy_cost);
    }
    begin_.push_back(static_cast<CandidateId>(candidates_.size()));
    offset_ += dearest;
  }
  check();
  TeamSet nobody(*this);
  by_value_.resize(candidates_.size());
  std::iota(by_value_.begin(), by_value_.end(), 0);
  for (const CandidateId id : by_value_) {
    const Candidate& of = candidate(id);
    alone_.push_back(of.mutual_nats && is_submodular()
                         ? *of.mutual_nats + (of.unshared_nats - of.energy_cost)
                         : nobody.value_with(id));
  }
  calls_ = nobody.calls();
  for (int robot = 0; robot < robot_count(); ++robot) {
    std::stable_sort(by_value_.begin() + begin(robot), by_value_.begin() + end(robot),
                     [this](CandidateId a, CandidateId b) { return alone(a) > alone(b); });
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
    const Look* last = nullptr;
    for (const Look& look : candidate->looks) {
      require(
          look.target < target_count() && look.step >= 1 && look.step <= problem_->horizon_steps,
          "team: each look must name a target, and a step of the horizon");
      require(last == nullptr || last->target < look.target ||
                  (last->target == look.target && last->step < look.step),
              "team: looks must be ordered by target, then by step");
      last = &look;
    }
  }
}

std::span<const CandidateId> TeamOracle::by_value(int robot) const {
  return {by_value_.data() + begin(robot), index(end(robot) - begin(robot))};
}

}  // namespace vantage::planner
