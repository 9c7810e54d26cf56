#include "planner/search/lattice_bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/infinity.hpp"
#include "planner/search/prefix_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/lattice_problem.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::planner {
namespace {

using test::FullTree;
using test::lattice_problem;
using test::OwnedProblem;

constexpr std::size_t kStates = 400'000;

/// Returns the number of problems, from the environment variable VANTAGE_BOUND_PROBLEMS; default
/// 250.
std::uint64_t problem_count() {
  const char* const text = std::getenv("VANTAGE_BOUND_PROBLEMS");
  return text != nullptr ? std::stoull(text) : 250;
}

// Returns the tolerance. At a distance of 1 mm the recursion of the search loses eight digits.
double tolerance(double cost) { return 1e-5 * std::max(1.0, std::abs(cost)); }

TEST(LatticeBound, IsBelowEveryCompletionOfEveryNode) {
  LatticeBound lattice(8, 8, kStates);
  std::vector<float> reference;
  std::uint64_t bounded = 0;
  for (std::uint64_t seed = 0; seed < problem_count(); ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = lattice_problem(seed);
    const FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    const std::vector<double> best = full.best_through(owned.problem.horizon_steps);
    lattice.reset(owned.problem, full.expander.beliefs());
    ASSERT_FALSE(lattice.is_empty());
    reference.resize(lattice.reference_size());
    lattice.begin(reference.data());
    std::mt19937_64 rng(seed);
    for (int i = 0; i < 12; ++i) {
      const NodeId id = i < 3 ? 0 : static_cast<NodeId>(rng() % full.tree.node_count());
      const Node& node = full.tree[id];
      if (node.depth == owned.problem.horizon_steps) {
        continue;
      }
      const std::size_t states = i % 2 == 0 ? kStates : 20'000;
      std::int64_t work_nodes = 0;
      const auto answer =
          lattice.cost_to_go(node.world_from_body, node.depth, full.tree.posterior(id),
                             reference.data(), 0.4, states, Deadline::never(), work_nodes);
      ASSERT_FALSE(answer.expired);
      bounded += answer.cost > -kInfinity ? 1U : 0U;
      ASSERT_LE(node.cost + answer.cost, best[id] + tolerance(best[id])) << "node " << id;
      for (std::int64_t budget_nodes = 0; budget_nodes < work_nodes;
           budget_nodes += 1 + work_nodes / 3) {
        std::int64_t cut_nodes = 0;
        EXPECT_TRUE(lattice
                        .cost_to_go(node.world_from_body, node.depth, full.tree.posterior(id),
                                    reference.data(), 0.4, states, Deadline::nodes(budget_nodes),
                                    cut_nodes)
                        .expired);
      }
      std::int64_t cut_nodes = 0;
      EXPECT_TRUE(lattice
                      .cost_to_go(node.world_from_body, node.depth, full.tree.posterior(id),
                                  reference.data(), 0.4, states, Deadline::nodes(work_nodes - 1),
                                  cut_nodes)
                      .expired)
          << "the last unit of work counts, too";
    }
  }
  EXPECT_GT(bounded, 4 * problem_count());
}

/// Expects the highest bound to be below the cost of the best plan, for a robot that drives 1 m per
/// step along x or uses `controls`.
void expect_bound_below_best(const std::vector<SearchTarget>& targets,
                             const std::vector<models::UnicycleControl>& controls = {
                                 {2.0, 0.0}, {2.0, 1.0}, {2.0, -1.0}}) {
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.start = {40.0, 30.0, 0.0};
  problem.horizon_steps = 3;
  problem.controls = controls;
  models::SensorModel sensor;
  sensor.range_min_m = 0.02;
  sensor.range_max_m = 4.0;
  problem.sensors = {sensor};
  problem.targets = targets;
  const FullTree full(problem);
  ASSERT_TRUE(full.complete);
  const double best = full.best_through(problem.horizon_steps)[0];
  LatticeBound lattice(8, 8, kStates);
  lattice.reset(problem, full.expander.beliefs());
  ASSERT_FALSE(lattice.is_empty());
  std::vector<float> reference(lattice.reference_size());
  lattice.begin(reference.data());
  double highest = -kInfinity;
  for (int i = 0; i < 30; ++i) {
    std::int64_t work_nodes = 0;
    const auto answer =
        lattice.cost_to_go(problem.start, 0, full.tree.posterior(0), reference.data(), 0.4, kStates,
                           Deadline::never(), work_nodes);
    ASSERT_LE(answer.cost, best + tolerance(best)) << i;
    highest = std::max(highest, answer.cost);
  }
  EXPECT_GT(highest, best - 10.0) << "the bound is too low to be useful";
}

/// Returns a target 2 cm next to the robot's path, `ahead_m` from its start, that moves along the
/// path.
SearchTarget target_near_path(double ahead_m, double speed_mps) {
  SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 1e-4}, {}};
  target.prior.mean = Eigen::Vector4d(40.0 + ahead_m, 30.021, speed_mps, 0.0);
  target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 1e-4, 1e-4).asDiagonal();
  return target;
}

// Two targets drive one behind the other at half the robot's speed. The robot reaches them at 1 m
// and 2 m. One step leads from the rear target to the front one, and no step leads back. A third
// target is never reached. The bound must hold for every order of the targets.
TEST(LatticeBound, AllowsStepBetweenNearbyTargets) {
  const std::vector<SearchTarget> targets = {target_near_path(0.5, 1.0), target_near_path(1.0, 1.0),
                                             target_near_path(30.0, 1.0)};
  std::vector<std::size_t> order = {0, 1, 2};
  do {
    SCOPED_TRACE(testing::Message() << order[0] << order[1] << order[2]);
    expect_bound_below_best({targets[order[0]], targets[order[1]], targets[order[2]]});
  } while (std::next_permutation(order.begin(), order.end()));
}

// The controls drive up to 1 m per step, in any order. The shortest or the longest control leads
// from one target to the other, in one or two steps.
TEST(LatticeBound, UsesShortestAndLongestStepInAnyOrder) {
  std::vector<models::UnicycleControl> controls = {{2.0, 0.0}, {1.5, 0.8}, {1.0, 0.0}};
  for (int turn = 0; turn < 3; ++turn) {
    std::rotate(controls.begin(), controls.begin() + 1, controls.end());
    for (const double apart_m : {0.5, 1.0, 1.5, 2.0}) {
      SCOPED_TRACE(testing::Message() << turn << ' ' << apart_m);
      expect_bound_below_best({target_near_path(1.0, 0.0), target_near_path(1.0 + apart_m, 0.0)},
                              controls);
    }
  }
}

// Two targets side by side overtake the robot at its position after one step.
TEST(LatticeBound, AllowsBeingNearTwoTargetsAtOnce) {
  expect_bound_below_best({target_near_path(-1.0, 4.0), target_near_path(-1.0, 4.0)});
}

// The first reference is isotropic: a tenth of the mean information of a measurement from half the
// range. It is 0 for targets that cannot be in range at the step.
TEST(LatticeBound, BeginsFromWeakReferenceForReachableTargets) {
  for (const models::SensorKind kind :
       {models::SensorKind::kRangeBearing, models::SensorKind::kBearing, models::SensorKind::kRange,
        models::SensorKind::kPosition}) {
    OwnedProblem owned;
    SearchProblem& problem = owned.problem;
    problem.start = {0.5, -1.0, 0.3};
    problem.horizon_steps = 4;
    problem.controls = {{1.0, 0.0}, {1.0, 1.0}, {1.0, -1.0}};
    models::SensorModel sensor;
    sensor.kind = kind;
    sensor.range_max_m = 3.0;
    problem.sensors = {sensor};
    const double away_m = sensor.range_max_m + 2.25 * problem.step_s;  // m; visible from step 3 on
    for (const double x_m : {0.5 + 1.0, 0.5 - away_m}) {
      problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                                 {Eigen::Vector2d(x_m, -1.0), Eigen::Matrix2d::Identity()}});
    }
    BeliefTable beliefs(8, 8);
    beliefs.reset(problem);
    LatticeBound lattice(8, 8, kStates);
    lattice.reset(problem, beliefs);
    ASSERT_FALSE(lattice.is_empty());
    std::vector<float> reference(lattice.reference_size(), -1.0F);
    lattice.begin(reference.data());
    const models::Viewpoint from{{-0.5 * sensor.range_max_m, 0.0, 0.0}, problem.height_m};
    const models::PositionVector target_m = Eigen::Vector2d::Zero();
    const double look = 0.5 * models::information(sensor, from, target_m).trace();
    for (std::size_t m = 0; m < 2; ++m) {
      for (std::size_t k = 1; k <= 4; ++k) {
        const float* const R = reference.data() + 3 * (4 * m + k - 1);
        const double expected = m == 0 || k >= 3 ? 0.1 * look : 0.0;
        EXPECT_NEAR(R[0], expected, 1e-6 * look) << kind.name() << " target " << m << " step " << k;
        EXPECT_EQ(R[1], 0.0F);
        EXPECT_EQ(R[2], R[0]);
      }
    }
  }
}

// Returns the problem mirrored left to right: positions, turns and beliefs.
SearchProblem mirrored(SearchProblem problem) {
  problem.start = {problem.start.x_m, -problem.start.y_m, -problem.start.yaw_rad};
  for (models::UnicycleControl& control : problem.controls) {
    control.yaw_rate_radps *= -1.0;
  }
  for (SearchTarget& target : problem.targets) {
    for (Eigen::Index i = 1; i < target.prior.mean.rows(); i += 2) {
      target.prior.mean(i) *= -1.0;
      target.prior.covariance.row(i) *= -1.0;
      target.prior.covariance.col(i) *= -1.0;
    }
  }
  for (auto& of_target : problem.fixed_information) {
    for (models::StateMatrix& M : of_target) {
      M(0, 1) = M(1, 0) = -M(0, 1);
    }
  }
  return problem;
}

TEST(LatticeBound, IsInvariantToReflection) {
  LatticeBound lattice(8, 8, kStates);
  BeliefTable beliefs(8, 8);
  const auto bound_of = [&](const SearchProblem& problem) {
    beliefs.reset(problem);
    lattice.reset(problem, beliefs);
    std::vector<float> reference(lattice.reference_size());
    lattice.begin(reference.data());
    std::int64_t work_nodes = 0;
    const double cost = lattice
                            .cost_to_go(problem.start, 0, {}, reference.data(), 0.0, kStates,
                                        Deadline::never(), work_nodes)
                            .cost;
    return std::pair(cost, static_cast<double>(work_nodes));
  };
  int compared = 0;
  int same = 0;
  for (std::uint64_t seed = 1; seed < 100; ++seed) {
    OwnedProblem owned = lattice_problem(seed);
    auto& controls = owned.problem.controls;
    const bool stands = std::any_of(controls.begin(), controls.end(),
                                    [](const auto& control) { return control.speed_mps == 0.0; });
    if (stands || seed % 3 == 0) {
      continue;  // asymmetric in the lattice: static targets and oscillators
    }
    controls[0].yaw_rate_radps = controls[2].yaw_rate_radps;  // straight driving is asymmetric, too
    const auto [cost, work_nodes] = bound_of(owned.problem);
    const auto [turned, turned_nodes] = bound_of(mirrored(owned.problem));
    ++compared;
    same += std::abs(turned - cost) < 1e-5 * std::max(1.0, std::abs(cost)) ? 1 : 0;
    EXPECT_NEAR(turned, cost, 0.01 * std::max(1.0, std::abs(cost))) << seed;
    EXPECT_NEAR(turned_nodes, work_nodes, 0.02 * work_nodes) << seed;
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(same, 0.9 * compared);  // chords along cell edges are asymmetric
}

TEST(PrefixBound, ConvergesToTheOptimumFromBelow) {
  PrefixBound prefix(8, 8);
  for (std::uint64_t seed = 0; seed < problem_count(); ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = lattice_problem(seed);
    FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    const double best = full.best_through(owned.problem.horizon_steps)[0];
    prefix.reset(owned.problem, full.expander);
    double before = -kInfinity;
    std::int64_t work_nodes = 0;
    for (int i = 0; i < 400; ++i) {
      const auto answer = prefix.raise(work_nodes + 20'000, Deadline::never(), work_nodes);
      ASSERT_FALSE(answer.expired);
      ASSERT_GE(answer.cost, before);
      before = answer.cost;
      ASSERT_LE(answer.cost, best + tolerance(best));
    }
    EXPECT_GE(before, best - tolerance(best));
  }
}

TEST(PrefixBound, ReturnsProvenBoundAtDeadline) {
  PrefixBound prefix(8, 8);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const OwnedProblem owned = lattice_problem(seed);
    FullTree full(owned.problem);
    const double best = full.best_through(owned.problem.horizon_steps)[0];
    for (const std::int64_t budget_nodes : {1, 1'000, 30'000}) {
      prefix.reset(owned.problem, full.expander);
      std::int64_t work_nodes = 0;
      const auto answer = prefix.raise(1'000'000'000, Deadline::nodes(budget_nodes), work_nodes);
      ASSERT_LE(answer.cost, best + tolerance(best));
      EXPECT_TRUE(answer.expired || answer.cost >= best - tolerance(best));
    }
  }
}

// With 150 visible targets, the blocks of a node have 1500 numbers.
TEST(PrefixBound, UsesWholeBudgetWithManyTargets) {
  std::mt19937_64 rng(5);
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = 6;
  problem.controls = {{1.0, 0.0}, {1.0, 1.0}, {1.0, -1.0}};
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.range_max_m = 0.7;
  problem.sensors = {sensor};
  for (int m = 0; m < 150; ++m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.01}, {}};
    target.prior.mean =
        Eigen::Vector4d(test::uniform(rng, -0.1, 0.1), test::uniform(rng, -0.1, 0.1), 0.0, 0.0);
    target.prior.covariance = Eigen::Matrix4d::Identity();
    problem.targets.push_back(target);
  }
  Expander expander(150, 8, 1);
  expander.reset(problem);
  PrefixBound prefix(150, 8);
  prefix.reset(problem, expander);
  ASSERT_FALSE(prefix.is_empty());
  std::int64_t work_nodes = 0;
  static_cast<void>(prefix.raise(30'000'000, Deadline::never(), work_nodes));
  EXPECT_GE(work_nodes, 30'000'000);
}

TEST(PrefixBound, AllocatesNothing) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "not with sanitizers";
  }
  PrefixBound prefix(8, 8);
  const OwnedProblem owned = lattice_problem(3);
  FullTree full(owned.problem);
  const test::AllocationCounter allocations;
  prefix.reset(owned.problem, full.expander);
  std::int64_t work_nodes = 0;
  static_cast<void>(prefix.raise(300'000, Deadline::never(), work_nodes));
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(LatticeBound, IsUnusedWhereItsConditionsFail) {
  OwnedProblem owned = lattice_problem(0);
  BeliefTable beliefs(8, 8);
  LatticeBound lattice(8, 8, kStates);
  owned.problem.cost = CostKind::kTrace;
  beliefs.reset(owned.problem);
  lattice.reset(owned.problem, beliefs);
  EXPECT_TRUE(lattice.is_empty());
  owned.problem.cost = CostKind::kLogDet;
  owned.problem.controls[1].yaw_rate_radps *= std::sqrt(2.0);
  beliefs.reset(owned.problem);
  lattice.reset(owned.problem, beliefs);
  EXPECT_TRUE(lattice.is_empty());
}

}  // namespace
}  // namespace vantage::planner
