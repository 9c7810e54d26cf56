#include "test/planner/decision/team_instance.hpp"

#include "test/planner/problem/random_problem.hpp"

namespace vantage::test {
namespace {

using planner::Candidate;
using planner::PredictedMeasurement;
using planner::TeamProblem;

planner::SearchTarget random_target(std::mt19937_64& rng) {
  planner::SearchTarget target;
  const int kind = pick(rng, 0, 3);
  target.model.kind = kind == 0   ? models::TargetKind::kStatic
                      : kind <= 1 ? models::TargetKind::kRandomWalk
                                  : models::TargetKind::kDoubleIntegrator;
  target.model.position_dim = kind == 1 && pick(rng, 0, 1) == 0 ? 3 : 2;
  target.model.q = uniform(rng, 0.0, 0.5);
  const int n = target.model.dim();
  target.prior.mean = models::StateVector::Zero(n);
  target.prior.covariance = random_spd(rng, n, uniform(rng, 0.3, 3.0), 1.5);
  return target;
}

PredictedMeasurement random_look(std::mt19937_64& rng, const planner::SearchTarget& target, int m,
                                 int step) {
  const int p = target.model.position_dim;
  const int rank = pick(rng, 1, p);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(p, p);
  for (int i = 0; i < rank; ++i) {
    Eigen::VectorXd h(p);
    for (int j = 0; j < p; ++j) {
      h(j) = uniform(rng, -1.0, 1.0);
    }
    M += uniform(rng, 0.1, 20.0) * h * h.transpose();
  }
  PredictedMeasurement look{static_cast<std::uint16_t>(m), static_cast<std::uint16_t>(step), {}};
  planner::pack(p == 3 ? planner::BlockLayout::kSpatial : planner::BlockLayout::kPlanar, M,
                look.information.m);
  return look;
}

Candidate random_candidate(std::mt19937_64& rng, const TeamProblem& problem, double cost_max) {
  Candidate candidate;
  candidate.energy_cost = uniform(rng, 0.0, cost_max);
  const double share_seen = uniform(rng, 0.0, 0.7);
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    for (int t = 1; t <= problem.horizon_steps; ++t) {
      if (uniform(rng, 0.0, 1.0) < share_seen) {
        candidate.measurements.push_back(
            random_look(rng, problem.targets[m], static_cast<int>(m), t));
      }
    }
  }
  return candidate;
}

}  // namespace

TeamProblem random_instance(std::uint64_t seed, const InstanceLimits& limits,
                            planner::InformationMeasure measure) {
  std::mt19937_64 rng(seed);
  TeamProblem problem;
  problem.measure = measure;
  problem.horizon_steps = pick(rng, 1, 4);
  problem.step_s = uniform(rng, 0.2, 1.0);
  const int targets = pick(rng, 1, 3);
  for (int m = 0; m < targets; ++m) {
    problem.targets.push_back(random_target(rng));
  }
  int left = limits.candidates_all;
  problem.candidates.resize(static_cast<std::size_t>(pick(rng, 1, limits.robots_max)));
  for (std::vector<Candidate>& of_robot : problem.candidates) {
    const int count =
        std::min(left, pick(rng, pick(rng, 0, 9) == 0 ? 0 : 1, limits.candidates_max));
    left -= count;
    for (int i = 0; i < count; ++i) {
      const bool twin = i > 0 && pick(rng, 0, 7) == 0;
      of_robot.push_back(twin ? of_robot.back() : random_candidate(rng, problem, limits.cost_max));
    }
  }
  return problem;
}

double plain_value(const TeamProblem& problem, const std::vector<const Candidate*>& chosen) {
  double nats = 0.0;
  for (std::size_t m = 0; m < problem.targets.size(); ++m) {
    const planner::SearchTarget& target = problem.targets[m];
    const models::StateMatrix A = target.model.transition(problem.step_s);
    const models::StateMatrix W = target.model.process_noise(problem.step_s);
    const int p = target.model.position_dim;
    models::Gaussian belief = target.prior;
    models::Gaussian unseen = target.prior;
    for (int t = 1; t <= problem.horizon_steps; ++t) {
      belief = models::predict(belief, A, W);
      unseen = models::predict(unseen, A, W);
      models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
      for (const Candidate* candidate : chosen) {
        for (const PredictedMeasurement& look : candidate->measurements) {
          if (look.target == m && look.step == t) {
            M += planner::unpack(
                p == 3 ? planner::BlockLayout::kSpatial : planner::BlockLayout::kPlanar,
                look.information.m);
          }
        }
      }
      const double before = problem.measure == planner::InformationMeasure::kMutual
                                ? models::log_det(belief.covariance)
                                : models::log_det(unseen.covariance);
      belief.covariance = models::update_covariance(belief.covariance, M);
      nats += 0.5 * (before - models::log_det(belief.covariance));
    }
  }
  for (const Candidate* candidate : chosen) {
    nats -= candidate->energy_cost;
  }
  return nats;
}

std::vector<const Candidate*> chosen_of(const planner::TeamOracle& oracle,
                                        const planner::Choice& choice) {
  std::vector<const Candidate*> chosen;
  for (const planner::CandidateId id : choice) {
    if (id != planner::kNoCandidate) {
      chosen.push_back(&oracle.candidate(id));
    }
  }
  return chosen;
}

planner::Choice random_choice(const planner::TeamOracle& oracle, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  planner::Choice choice;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    const int count = oracle.end(robot) - oracle.begin(robot);
    const int drawn = pick(rng, -1, count - 1);
    choice.push_back(drawn < 0 ? planner::kNoCandidate : oracle.begin(robot) + drawn);
  }
  return choice;
}

}  // namespace vantage::test
