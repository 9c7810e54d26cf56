#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/infinity.hpp"
#include "planner/search/lattice_bound.hpp"
#include "planner/search/root_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/lattice_problem.hpp"

// Bounds must not depend on earlier problems or on the frame. A bound at a depth of a plan must
// equal the bound of a problem that begins there.

namespace vantage::planner {
namespace {

using test::lattice_problem;
using test::OwnedProblem;
using test::pick;
using test::random_spd;
using test::uniform;

constexpr std::size_t kStates = 10'000;

double play(double cost) { return 1e-7 * std::max(1.0, std::abs(cost)); }

struct RootAnswers {
  double any = 0.0;
  double moving = 0.0;
  double raised = 0.0;
  std::int64_t work_nodes = 0;
};

RootAnswers answers_of(RootBound& root, const SearchProblem& problem, Expander& expander,
                       std::int64_t raise_nodes) {
  RootAnswers out;
  expander.reset(problem);
  out.any = root.of_any_plan(problem, expander.beliefs());
  out.moving = root.of_moving_plan(Deadline::never(), out.work_nodes).cost;
  if (raise_nodes > 0) {
    out.raised =
        root.raise(expander, out.work_nodes + raise_nodes, Deadline::never(), out.work_nodes).cost;
  }
  return out;
}

TEST(RootBound, IsIndependentOfEarlierProblems) {
  RootBound used(8, 8);
  Expander expander(8, 8, 4);
  int raised = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = seed % 2 == 0 ? lattice_problem(seed) : test::random_problem(seed);
    const RootAnswers again = answers_of(used, owned.problem, expander, 3'000);
    RootBound fresh(8, 8);
    const RootAnswers first = answers_of(fresh, owned.problem, expander, 3'000);
    EXPECT_EQ(again.any, first.any);
    EXPECT_EQ(again.moving, first.moving);
    EXPECT_EQ(again.raised, first.raised);
    EXPECT_EQ(again.work_nodes, first.work_nodes);
    raised += first.raised > first.moving ? 1 : 0;
  }
  EXPECT_GT(raised, 1);
}

/// Returns the problem mirrored in the x axis if `is_mirrored`, then turned, then shifted.
SearchProblem transformed(const SearchProblem& problem, bool is_mirrored, double turn_rad,
                          const Eigen::Vector2d& shift_m) {
  const double side = is_mirrored ? -1.0 : 1.0;
  const Eigen::Matrix2d Q =
      Eigen::Rotation2Dd(turn_rad).toRotationMatrix() * Eigen::Vector2d(1.0, side).asDiagonal();
  SearchProblem out = problem;
  const Eigen::Vector2d start_m = Q * problem.start.position_m() + shift_m;
  out.start = {start_m.x(), start_m.y(), wrap_to_pi(turn_rad + side * problem.start.yaw_rad)};
  for (models::UnicycleControl& control : out.controls) {
    control.yaw_rate_radps *= side;
  }
  for (SearchTarget& target : out.targets) {
    const int n = target.model.dim();
    Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
    for (int i = 0; i + 1 < n; i += 2) {
      all.block<2, 2>(i, i) = Q;
    }
    const Eigen::MatrixXd turned = all * target.prior.covariance * all.transpose();
    target.prior.mean = (all * target.prior.mean).eval();
    target.prior.mean.head<2>() += shift_m;
    target.prior.covariance = 0.5 * (turned + turned.transpose());
  }
  for (auto& of_target : out.fixed_information) {
    for (models::StateMatrix& M : of_target) {
      if (M.size() > 0) {
        const Eigen::Index p = M.rows();
        Eigen::MatrixXd all = Eigen::MatrixXd::Identity(p, p);
        all.topLeftCorner(2, 2) = Q;
        const Eigen::MatrixXd turned = all * M * all.transpose();
        M = 0.5 * (turned + turned.transpose());
      }
    }
  }
  return out;
}

/// Returns a problem with several moving and static targets so near to the robot that all parts of
/// the bounds contribute.
SearchProblem crowded(std::mt19937_64& rng) {
  SearchProblem problem;
  problem.start = {uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -kPi, kPi)};
  problem.height_m = 1.0;
  problem.horizon_steps = pick(rng, 2, 5);
  const double speed_mps = uniform(rng, 0.3, 2.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 2.0}, {0.6 * speed_mps, -1.3}};
  problem.cost = pick(rng, 0, 1) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  for (int i = pick(rng, 1, 2); i > 0; --i) {
    models::SensorModel sensor;
    sensor.kind = models::all_sensor_kinds()[index(pick(rng, 0, 4))];
    sensor.range_max_m = uniform(rng, 1.0, 4.0);
    sensor.range_min_m = 0.05;
    sensor.fov_rad = pick(rng, 0, 1) == 0 ? 2.0 * kPi : radians(uniform(rng, 60.0, 300.0));
    sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
    sensor.depth_min_m = 0.3;
    problem.sensors.push_back(sensor);
  }
  for (int m = pick(rng, 2, 6); m > 0; --m) {
    const models::TargetModel kinds[] = {{models::TargetKind::kStatic, 2, 0.0},
                                         {models::TargetKind::kRandomWalk, 2, 0.02},
                                         {models::TargetKind::kDoubleIntegrator, 2, 0.01},
                                         {models::TargetKind::kDoubleIntegrator, 2, 0.01},
                                         {models::TargetKind::kRandomWalk, 3, 0.01}};
    SearchTarget target{kinds[pick(rng, 0, 4)], {}};
    const int n = target.model.dim();
    target.prior.mean = models::StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
      target.prior.mean(i) = i < 2 ? uniform(rng, -2.0, 2.0) : uniform(rng, -0.4, 0.4);
    }
    target.prior.covariance = random_spd(rng, n, uniform(rng, 0.1, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  if (pick(rng, 0, 3) == 0) {
    for (const SearchTarget& target : problem.targets) {
      problem.fixed_information.emplace_back(index(problem.horizon_steps));
      if (pick(rng, 0, 1) == 0) {
        const int k = pick(rng, 0, problem.horizon_steps - 1);
        problem.fixed_information.back()[index(k)] =
            random_spd(rng, target.model.position_dim, 10.0, 1.0);
      }
    }
  }
  return problem;
}

TEST(RootBound, IsInvariantToFrameAndTargetOrder) {
  RootBound root(8, 8);
  Expander expander(8, 8, 4);
  std::mt19937_64 rng(81);
  int above = 0;
  for (int trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    const SearchProblem problem = crowded(rng);
    const RootAnswers plain = answers_of(root, problem, expander, 0);
    const auto expect_alike = [&](const SearchProblem& other, const char* what) {
      const RootAnswers answers = answers_of(root, other, expander, 0);
      if (!std::isfinite(plain.any)) {
        EXPECT_EQ(answers.any, plain.any) << what;
        return;
      }
      EXPECT_NEAR(answers.any, plain.any, play(plain.any)) << what;
      EXPECT_NEAR(answers.moving, plain.moving, play(plain.moving)) << what;
    };
    expect_alike(transformed(problem, true, 0.0, {0.0, 0.0}), "mirrored");
    expect_alike(transformed(problem, false, uniform(rng, -kPi, kPi), {7.0, -9.0}), "turned");
    SearchProblem renamed = problem;
    std::reverse(renamed.targets.begin(), renamed.targets.end());
    std::reverse(renamed.fixed_information.begin(), renamed.fixed_information.end());
    expect_alike(renamed, "renamed");
    SearchProblem regrouped = problem;
    std::reverse(regrouped.sensors.begin(), regrouped.sensors.end());
    std::reverse(regrouped.controls.begin(), regrouped.controls.end());
    expect_alike(regrouped, "its sensors and controls in another order");
    above += plain.moving > plain.any + 0.01 ? 1 : 0;
  }
  EXPECT_GT(above, 30);
}

// Returns the problem that begins at `depth`, after steps in which the robot measures nothing.
SearchProblem rest_of(const SearchProblem& problem, int depth) {
  SearchProblem out = problem;
  out.horizon_steps -= depth;
  for (std::size_t m = 0; m < out.targets.size(); ++m) {
    models::Gaussian& belief = out.targets[m].prior;
    for (int k = 1; k <= depth; ++k) {
      belief = models::predict(belief, out.targets[m].model, out.step_s);
      if (!out.fixed_information.empty()) {
        const models::PositionMatrix M = out.fixed_information[m].front();
        out.fixed_information[m].erase(out.fixed_information[m].begin());
        if (M.size() > 0) {
          belief.covariance = models::update_covariance(belief.covariance, M);
        }
      }
    }
  }
  return out;
}

TEST(InformationHeuristic, AtADepthEqualsThatOfTheRemainingProblem) {
  InformationHeuristic heuristic(8, 8);
  InformationHeuristic of_rest(8, 8);
  BeliefTable beliefs(8, 8);
  BeliefTable beliefs_of_rest(8, 8);
  int finite = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    std::mt19937_64 rng(seed);
    for (std::size_t m = 0; m < problem.fixed_information.size(); ++m) {
      const int p = problem.targets[m].model.position_dim;
      for (models::StateMatrix& M : problem.fixed_information[m]) {
        M = random_spd(rng, p, 5.0, 1.0);  // at each step, also after `depth`
      }
    }
    if (problem.horizon_steps == 1) {
      continue;
    }
    const int depth = pick(rng, 1, problem.horizon_steps - 1);
    const SearchProblem rest = rest_of(problem, depth);
    beliefs.reset(problem);
    heuristic.reset(problem, beliefs);
    beliefs_of_rest.reset(rest);
    of_rest.reset(rest, beliefs_of_rest);
    const double is = heuristic.cost_to_go(problem.start, depth, {});
    const double expected = of_rest.cost_to_go(rest.start, 0, {});
    if (!std::isfinite(expected)) {
      EXPECT_EQ(is, expected);
      continue;
    }
    ++finite;
    EXPECT_NEAR(is, expected, play(expected));
  }
  EXPECT_GT(finite, 30);
}

std::vector<double> lattice_bounds(LatticeBound& lattice, const SearchProblem& problem, int depth,
                                   std::vector<float> reference, int times) {
  std::vector<double> out;
  for (int i = 0; i < times; ++i) {
    std::int64_t work_nodes = 0;
    out.push_back(lattice
                      .cost_to_go(problem.start, depth, {}, reference.data(), 0.4, kStates,
                                  Deadline::never(), work_nodes)
                      .cost);
  }
  return out;
}

/// Returns a lattice problem in which all targets move equally, so that their relative positions
/// are constant.
SearchProblem moving_alike(std::uint64_t seed, std::mt19937_64& rng) {
  SearchProblem problem = lattice_problem(seed).problem;
  problem.horizon_steps = 5;
  problem.controls.resize(3);
  const Eigen::Vector2d velocity_mps(uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5));
  for (SearchTarget& target : problem.targets) {
    target.model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
    const Eigen::Vector2d place_m = target.prior.mean.head<2>();
    target.prior.mean = models::StateVector::Zero(4);
    target.prior.mean << place_m, velocity_mps;
    target.prior.covariance = random_spd(rng, 4, uniform(rng, 0.1, 2.0), 1.0);
  }
  if (!problem.fixed_information.empty()) {
    for (auto& of_target : problem.fixed_information) {
      of_target.resize(index(problem.horizon_steps), random_spd(rng, 2, 20.0, 2.0));
    }
  }
  return problem;
}

TEST(LatticeBound, AtADepthEqualsBoundOfTheRemainingProblem) {
  LatticeBound lattice(8, 8, kStates);
  BeliefTable beliefs(8, 8);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const SearchProblem problem = moving_alike(seed, rng);
    const int depth = pick(rng, 1, 2);
    beliefs.reset(problem);
    lattice.reset(problem, beliefs);
    ASSERT_FALSE(lattice.is_empty());
    std::vector<float> reference(lattice.reference_size());
    lattice.begin(reference.data());
    const std::vector<double> is = lattice_bounds(lattice, problem, depth, reference, 4);

    const SearchProblem rest = rest_of(problem, depth);
    std::vector<float> reference_of_rest;
    const std::size_t floats = 3 * index(problem.horizon_steps);  // per target
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      const auto begin = reference.begin() + static_cast<std::ptrdiff_t>(m * floats);
      reference_of_rest.insert(reference_of_rest.end(), begin + 3 * depth,
                               begin + static_cast<std::ptrdiff_t>(floats));
    }
    beliefs.reset(rest);
    lattice.reset(rest, beliefs);
    ASSERT_EQ(lattice.reference_size(), reference_of_rest.size());
    const std::vector<double> expected = lattice_bounds(lattice, rest, 0, reference_of_rest, 4);
    for (std::size_t i = 0; i < is.size(); ++i) {
      EXPECT_NEAR(is[i], expected[i], 1e-4 * std::max(1.0, std::abs(expected[i]))) << i;
    }
  }
}

// A lattice uses the frame of its start pose. A rotation and shift of all positions does not change
// its first bound or the bounds with an improved reference.
TEST(LatticeBound, IsInvariantToTheFrame) {
  LatticeBound lattice(8, 8, kStates);
  BeliefTable beliefs(8, 8);
  int alike = 0;
  int compared = 0;
  double risen = 0.0;
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    if (seed % 3 == 0) {
      continue;  // oscillators depend on the direction
    }
    SCOPED_TRACE(seed);
    const OwnedProblem owned = lattice_problem(seed);
    const auto bounds_of = [&](const SearchProblem& problem) {
      beliefs.reset(problem);
      lattice.reset(problem, beliefs);
      std::vector<float> reference(lattice.reference_size());
      lattice.begin(reference.data());
      return lattice_bounds(lattice, problem, 0, reference, 6);
    };
    const std::vector<double> plain = bounds_of(owned.problem);
    const std::vector<double> turned =
        bounds_of(transformed(owned.problem, false, 0.1 * static_cast<double>(seed), {11.0, -5.0}));
    EXPECT_NEAR(turned[0], plain[0], 1e-4 * std::max(1.0, std::abs(plain[0])));
    for (std::size_t i = 1; i < plain.size(); ++i) {
      ++compared;
      alike += std::abs(turned[i] - plain[i]) < 1e-3 * std::max(1.0, std::abs(plain[i])) ? 1 : 0;
    }
    risen += *std::max_element(plain.begin(), plain.end()) - plain[0];
  }
  EXPECT_GT(alike, 0.95 * compared);  // equally good paths differ by rounding
  EXPECT_GT(risen, 20.0);             // nats; about 0.5 nats per problem
}

}  // namespace
}  // namespace vantage::planner
