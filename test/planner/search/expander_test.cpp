#include "planner/search/expander.hpp"

#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

namespace vantage::planner {
namespace {

using test::FullTree;
using test::is_near;
using test::uniform;

constexpr std::uint64_t kProblems = 240;

TEST(Expander, CostsEqualThoseOfTheScorer) {
  std::size_t nodes = 0;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    for (NodeId id = 1; id < full.tree.node_count(); ++id) {
      const double expected = score(owned.problem, full.path(id));
      ASSERT_NEAR(full.tree[id].cost, expected, 1e-8 * std::max(1.0, std::abs(expected)))
          << "seed " << seed << " node " << id;
    }
    nodes += full.tree.node_count();
  }
  EXPECT_GT(nodes, 20'000u);
}

TEST(Expander, CovariancesEqualTheModels) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const FullTree full(owned.problem);
    for (NodeId id = 0; id < full.tree.node_count(); id += 7) {
      test::OracleState state = test::start_of(owned.problem);
      for (const Pose2& pose : full.path(id)) {
        ++state.depth;
        state.beliefs = test::look_from(owned.problem, state.beliefs, pose, state.depth);
      }
      for (std::size_t m = 0; m < state.beliefs.size(); ++m) {
        const models::StateMatrix& expected = state.beliefs[m].covariance;
        ASSERT_TRUE(
            is_near(full.covariance(id, static_cast<int>(m)), expected, 1e-9 * expected.norm()))
            << "seed " << seed << " node " << id;
      }
    }
  }
}

// Products of determinants must neither overflow nor underflow.
TEST(Expander, NeitherOverflowsNorUnderflowsForSharpMeasurements) {
  for (const models::TargetKind kind :
       {models::TargetKind::kRandomWalk, models::TargetKind::kDoubleIntegrator}) {
    SearchProblem problem;
    problem.horizon_steps = 3;
    problem.controls = {{0.0, 0.0}};
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.position_sigma_m = 1e-2;
    problem.sensors = {sensor};
    for (int m = 0; m < 60; ++m) {
      SearchTarget target{{kind, 2, 1e-6}, {}};
      const int n = target.model.dim();
      target.prior.mean = models::StateVector::Zero(n);
      target.prior.mean(0) = 1.0 + 0.1 * m;
      target.prior.covariance = 1e3 * models::StateMatrix::Identity(n, n);
      problem.targets.push_back(target);
    }
    const FullTree full(problem);
    const NodeId last = static_cast<NodeId>(full.tree.node_count() - 1);
    const double expected = score(problem, full.path(last));
    EXPECT_NEAR(full.tree[last].cost, expected, 1e-8 * std::abs(expected));
  }
}

TEST(Expander, SupportsAPositionSensorExactlyAtTheTarget) {
  SearchProblem problem;
  problem.horizon_steps = 1;
  problem.controls = {{0.0, 0.0}};
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  problem.sensors = {sensor};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  const FullTree full(problem);
  EXPECT_NEAR(full.tree[1].cost, score(problem, {problem.start}), 1e-12);
}

TEST(Expander, HasCapacityForAllControlsAtAnyHorizon) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  OwnedProblem owned = test::random_problem(1);
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = 1;
  problem.controls.assign(kMaxControls, {1.0, 0.5});
  problem.fixed_information.clear();
  Expander expander(8, 1, 4);
  const test::AllocationCounter allocations;
  expander.reset(problem);
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(Expander, HoverCostEqualsThatOfTheScorer) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    FullTree full(owned.problem);
    SCOPED_TRACE(seed);
    full.expect_hover_costs(owned.problem);
  }
}

// Calls check(a, b) for random pairs of nodes of equal depth.
template <class Check>
void for_random_pairs(FullTree& full, int pairs, std::mt19937_64& rng, const Check& check) {
  for (int i = 0; i < pairs; ++i) {
    const NodeId a = static_cast<NodeId>(rng() % full.tree.node_count());
    const NodeId b = static_cast<NodeId>(rng() % full.tree.node_count());
    if (full.tree[a].depth == full.tree[b].depth) {
      check(a, b);
    }
  }
}

TEST(IsRedundant, ImpliesThatTheJointCovarianceDominates) {
  std::mt19937_64 rng(22);
  int redundant = 0;
  int tested = 0;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    FullTree full(owned.problem);
    for_random_pairs(full, 60, rng, [&](NodeId a, NodeId b) {
      const double epsilon =
          test::pick(rng, 0, 2) == 0 ? 0.0 : std::pow(10.0, uniform(rng, -4.0, 1.0));
      Eigen::MatrixXd difference = full.joint_covariance(a) - full.joint_covariance(b);
      difference.diagonal().array() += epsilon;
      const double scale =
          full.joint_covariance(a).norm() + full.joint_covariance(b).norm() + epsilon;
      const double least =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues()(0);
      ++tested;
      if (full.expander.is_redundant(full.tree, a, epsilon, b)) {
        ++redundant;
        EXPECT_GE(least, -1e-12 * scale) << "seed " << seed;
      } else {
        EXPECT_LE(least, 1e-12 * scale) << "too conservative, seed " << seed;
      }
    });
  }
  EXPECT_GT(redundant, 300);
  EXPECT_GT(tested - redundant, 300);
}

// This property allows pruning: with less information no completion is cheaper.
TEST(IsRedundant, ImpliesThatNoCompletionIsBetter) {
  std::mt19937_64 rng(23);
  int compared = 0;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    FullTree full(owned.problem);
    int left = 3;
    for_random_pairs(full, 200, rng, [&](NodeId a, NodeId b) {
      const int depth = full.tree[a].depth;
      if (left == 0 || a == b || depth == 0 || depth == owned.problem.horizon_steps ||
          owned.problem.horizon_steps - depth > 3 ||
          !full.expander.is_redundant(full.tree, a, 0.0, b)) {
        return;
      }
      // Both beliefs are continued from the same pose.
      test::OracleState from_a = test::start_of(owned.problem);
      test::OracleState from_b = from_a;
      for (const Pose2& pose : full.path(a)) {
        from_a.beliefs = test::look_from(owned.problem, from_a.beliefs, pose, ++from_a.depth);
      }
      for (const Pose2& pose : full.path(b)) {
        from_b.beliefs = test::look_from(owned.problem, from_b.beliefs, pose, ++from_b.depth);
      }
      from_a.world_from_body = full.tree[b].world_from_body;
      from_b.world_from_body = from_a.world_from_body;
      const test::OracleAnswer best_a = test::best_completion(owned.problem, from_a);
      const test::OracleAnswer best_b = test::best_completion(owned.problem, from_b);
      ASSERT_EQ(best_a.found, best_b.found);
      if (best_a.found) {
        EXPECT_GE(best_a.cost, best_b.cost - 1e-9 * std::max(1.0, std::abs(best_b.cost)))
            << "seed " << seed;
        ++compared;
        --left;
      }
    });
  }
  EXPECT_GT(compared, 100);
}

}  // namespace
}  // namespace vantage::planner
