#include "planner/search/candidate_grid.hpp"

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::uniform;

SearchProblem scattered(std::mt19937_64& rng, int targets, double half_m, int horizon_steps) {
  SearchProblem problem;
  problem.horizon_steps = horizon_steps;
  problem.controls = models::standard_primitives();
  problem.start = {uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0), 0.0};
  for (int m = 0; m < targets; ++m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
    target.prior.mean =
        Eigen::Vector4d(uniform(rng, -half_m, half_m), uniform(rng, -half_m, half_m),
                        uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0));
    target.prior.covariance = Eigen::Matrix4d::Identity();
    problem.targets.push_back(target);
  }
  return problem;
}

// Expects the list at random positions of the reachable disc to contain each target that may be
// visible. Returns the mean length of the lists.
double expect_complete(const SearchProblem& problem, double reach_m, double range_m,
                       CandidateGrid& grid, std::mt19937_64& rng) {
  BeliefTable beliefs(static_cast<int>(problem.targets.size()), problem.horizon_steps);
  beliefs.reset(problem);
  grid.reset(beliefs, problem.start.position_m(), problem.horizon_steps, reach_m, range_m);
  double listed = 0.0;
  constexpr int kQueries = 2'000;
  for (int i = 0; i < kQueries; ++i) {
    const int t = test::pick(rng, 1, problem.horizon_steps);
    const double away_m = t * reach_m * (i % 3 == 0 ? 1.0 : uniform(rng, 0.0, 1.0));
    const double course_rad = uniform(rng, -kPi, kPi);
    const Eigen::Vector2d p_m =
        problem.start.position_m() +
        away_m * Eigen::Vector2d(std::cos(course_rad), std::sin(course_rad));
    const std::span<const std::uint16_t> near = grid.near(p_m, t);
    EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
    for (int m = 0; m < beliefs.target_count(); ++m) {
      if ((beliefs.mean_m(m, t).head<2>() - p_m).norm() < range_m + reach_m) {
        EXPECT_TRUE(std::binary_search(near.begin(), near.end(), static_cast<std::uint16_t>(m)))
            << "target " << m << " at depth " << t;
      }
    }
    listed += static_cast<double>(near.size()) / kQueries;
  }
  return listed;
}

TEST(CandidateGrid, ListsEveryTargetInSight) {
  std::mt19937_64 rng(31);
  CandidateGrid grid(400, 12);
  for (int problem = 0; problem < 30; ++problem) {
    const int horizon = test::pick(rng, 1, 12);
    const SearchProblem scene = scattered(rng, test::pick(rng, 0, 400), 40.0, horizon);
    const double reach_m = problem % 7 == 0 ? 0.0 : uniform(rng, 0.1, 2.0);
    expect_complete(scene, reach_m, uniform(rng, 0.5, 15.0), grid, rng);
    ASSERT_FALSE(HasFailure()) << problem;
  }
}

TEST(CandidateGrid, ListsEveryTargetWhenPoolIsFull) {
  std::mt19937_64 rng(32);
  CandidateGrid grid(3'000, 12);  // all targets visible: 3000 per cell
  const SearchProblem scene = scattered(rng, 3'000, 10.0, 6);
  expect_complete(scene, 1.5, 40.0, grid, rng);
}

// At equal density the length of a list does not depend on the number of targets.
TEST(CandidateGrid, CostIsIndependentOfDistantTargets) {
  std::mt19937_64 rng(33);
  CandidateGrid grid(1'000, 6);
  const double few = expect_complete(scattered(rng, 100, 64.0, 6), 1.5, 10.0, grid, rng);
  const double many =
      expect_complete(scattered(rng, 1'000, 64.0 * std::sqrt(10.0), 6), 1.5, 10.0, grid, rng);
  EXPECT_LT(few, 12.0);
  EXPECT_LT(many, 12.0);
}

// Up to four relevant targets at a depth are returned at every position. Of five, only those that
// may be visible from the position are returned.
TEST(CandidateGrid, FiltersOnlyMoreThanFourTargets) {
  for (const int count : {1, 4, 5}) {
    SearchProblem problem;
    problem.horizon_steps = 2;
    problem.controls = models::standard_primitives();
    for (int m = 0; m < count + 1; ++m) {  // the last one is out of reach
      const double x_m = m == count ? 6.5 : m % 2 == 0 ? 3.5 : -3.5;
      problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                                 {Eigen::Vector2d(x_m, 0.0), Eigen::Matrix2d::Identity()}});
    }
    BeliefTable beliefs(8, 2);
    beliefs.reset(problem);
    CandidateGrid grid(8, 2);
    grid.reset(beliefs, {0.0, 0.0}, 2, 2.0, 1.0);  // 2 m per step; a list holds targets within 3 m
    for (const double side : {1.0, -1.0}) {
      const std::span<const std::uint16_t> near = grid.near({1.9 * side, 0.0}, 1);
      std::vector<std::uint16_t> expected;
      for (int m = 0; m < count; ++m) {
        if (count <= 4 || (m % 2 == 0) == (side > 0.0)) {
          expected.push_back(static_cast<std::uint16_t>(m));
        }
      }
      EXPECT_EQ(std::vector<std::uint16_t>(near.begin(), near.end()), expected) << count << side;
    }
  }
}

}  // namespace
}  // namespace vantage::planner
