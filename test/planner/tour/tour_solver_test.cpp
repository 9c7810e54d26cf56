#include "planner/tour/tour_solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/support/allocation_counter.hpp"

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

constexpr int kSamples = 9;

// Draws robots and stops in a square of 100 m. Gains fall with the time of arrival; some of them
// rise first.
void draw(std::mt19937_64& rng, int stops, int robots, TourProblem& out) {
  out.resize(stops, robots, 10.0, uniform(rng, 0.0, 3.0));
  const auto draw_place = [&] {
    return Eigen::Vector2d(uniform(rng, 0.0, 100.0), uniform(rng, 0.0, 100.0));
  };
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < stops; ++i) {
    places.push_back(draw_place());
  }
  const double speed_mps = uniform(rng, 1.0, 6.0);
  for (int i = 0; i < stops; ++i) {
    for (int j = 0; j < stops; ++j) {
      out.travel_s(i, j) = (places[index(i)] - places[index(j)]).norm() / speed_mps;
    }
    const double rise = pick(rng, 0, 2) == 0 ? uniform(rng, 0.0, 4.0) : 0.0;
    const double gain = uniform(rng, 0.1, 5.0);
    for (int k = 0; k < kSamples; ++k) {
      const double left = 1.0 - static_cast<double>(k) / (kSamples - 1);
      out.gain(i, k) = (gain + rise * (1.0 - left)) * left;
    }
  }
  for (int robot = 0; robot < robots; ++robot) {
    const Eigen::Vector2d start = draw_place();
    const double free_s = uniform(rng, 0.0, 5.0);
    for (int i = 0; i < stops; ++i) {
      out.start_s(robot, i) = free_s + (places[index(i)] - start).norm() / speed_mps;
    }
  }
}

// Returns the greatest gain over all ordered subsets of the stops for each robot in turn.
double best_by_force(const TourProblem& problem, int robot, std::vector<std::uint16_t>& tour,
                     std::vector<bool>& used) {
  const double here = gain_of_tour(problem, robot, tour);
  double best = here;
  if (robot + 1 < problem.robot_count()) {
    std::vector<std::uint16_t> next;
    best = here + best_by_force(problem, robot + 1, next, used);
  }
  for (std::uint16_t i = 0; i < problem.stop_count(); ++i) {
    if (!used[i]) {
      used[i] = true;
      tour.push_back(i);
      best = std::max(best, best_by_force(problem, robot, tour, used));
      tour.pop_back();
      used[i] = false;
    }
  }
  return best;
}

double best_by_force(const TourProblem& problem) {
  std::vector<std::uint16_t> tour;
  std::vector<bool> used(index(problem.stop_count()));
  return best_by_force(problem, 0, tour, used);
}

double sum_of_tours(const TourProblem& problem, const TourSolver& solver) {
  double sum = 0.0;
  std::set<int> visited;
  for (int robot = 0; robot < problem.robot_count(); ++robot) {
    sum += gain_of_tour(problem, robot, solver.tour(robot));
    for (const std::uint16_t stop : solver.tour(robot)) {
      EXPECT_LT(stop, problem.stop_count());
      EXPECT_TRUE(visited.insert(stop).second) << "stop " << stop << " is visited twice";
    }
  }
  return sum;
}

TEST(TourSolver, FindsTheOptimumOfMostSmallProblems) {
  TourProblem problem(6, 2, kSamples);
  TourSolver solver(6, 2);
  int optimal = 0;
  double least_ratio = 1.0;
  constexpr int kDraws = 150;
  for (int seed = 0; seed < kDraws; ++seed) {
    std::mt19937_64 rng(static_cast<std::uint64_t>(seed));
    const int robots = pick(rng, 1, 2);
    draw(rng, pick(rng, 1, robots == 1 ? 6 : 4), robots, problem);
    solver.solve(problem, Deadline::never());
    EXPECT_TRUE(solver.is_finished());
    const double best = best_by_force(problem);
    EXPECT_LE(solver.gain(), best * (1.0 + 1e-12));
    least_ratio = std::min(least_ratio, solver.gain() / best);
    optimal += solver.gain() >= best * (1.0 - 1e-9) ? 1 : 0;
  }
  RecordProperty("optimal", optimal);
  std::printf("optimal in %d of %d, least ratio %.4f\n", optimal, kDraws, least_ratio);
  EXPECT_GT(optimal, kDraws * 8 / 10);
  EXPECT_GT(least_ratio, 0.9);
}

TEST(TourSolver, VisitsEachStopAtMostOnceAndReturnsTheTotalGain) {
  TourProblem problem(40, 4, kSamples);
  TourSolver solver(40, 4);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 rng(seed);
    draw(rng, pick(rng, 0, 40), pick(rng, 1, 4), problem);
    solver.solve(problem, Deadline::never());
    EXPECT_NEAR(solver.gain(), sum_of_tours(problem, solver), 1e-9);
  }
}

TEST(TourSolver, NeverGetsWorseWithAGreaterBudget) {
  TourProblem problem(30, 2, kSamples);
  TourSolver solver(30, 2);
  std::mt19937_64 rng(5);
  draw(rng, 30, 2, problem);
  double before = 0.0;
  for (std::int64_t budget = 0; budget < 400'000; budget = 2 * budget + 10) {
    solver.solve(problem, Deadline::nodes(budget));
    EXPECT_NEAR(solver.gain(), sum_of_tours(problem, solver), 1e-9);
    EXPECT_GE(solver.gain(), before - 1e-9) << budget;
    EXPECT_LE(solver.work_nodes(), budget + 4 * 31) << "one move more than the budget";
    before = solver.gain();
  }
}

TEST(TourSolver, DependsOnTheProblemOnly) {
  TourProblem problem(25, 3, kSamples);
  TourSolver one(25, 3);
  TourSolver other(25, 3);
  std::mt19937_64 rng(8);
  draw(rng, 10, 1, problem);
  other.solve(problem, Deadline::never());  // leaves other contents in its arrays
  draw(rng, 25, 3, problem);
  for (const std::int64_t budget : {500, 5'000, 100'000}) {
    one.solve(problem, Deadline::nodes(budget));
    other.solve(problem, Deadline::nodes(budget));
    EXPECT_EQ(one.work_nodes(), other.work_nodes());
    for (int robot = 0; robot < 3; ++robot) {
      const auto a = one.tour(robot);
      const auto b = other.tour(robot);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
    }
  }
}

TEST(TourSolver, AllocatesNothing) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the sanitizer has its own allocator";
  }
  TourProblem problem(50, 3, kSamples);
  TourSolver solver(50, 3);
  std::mt19937_64 rng(3);
  draw(rng, 50, 3, problem);
  const test::AllocationCounter allocations;
  solver.solve(problem, Deadline::nodes(200'000));
  problem.resize(50, 3, 5.0, 1.0);
  EXPECT_EQ(allocations.count(), 0u);
}

TEST(TourSolver, SkipsStopsThatAreReachedTooLate) {
  TourProblem problem(2, 1, 3);
  TourSolver solver(2, 1);
  problem.resize(2, 1, 10.0, 1.0);
  for (int k = 0; k < 3; ++k) {
    problem.gain(0, k) = 2.0 - k;
    problem.gain(1, k) = 2.0 - k;
  }
  problem.start_s(0, 0) = 5.0;
  problem.start_s(0, 1) = 21.0;
  problem.travel_s(0, 1) = problem.travel_s(1, 0) = 16.0;
  solver.solve(problem, Deadline::never());
  ASSERT_EQ(solver.tour(0).size(), 1u);
  EXPECT_EQ(solver.tour(0)[0], 0);
  EXPECT_DOUBLE_EQ(solver.gain(), 1.5);
}

TEST(TourProblem, InterpolatesGains) {
  TourProblem problem(1, 1, 3);
  problem.resize(1, 1, 10.0, 0.0);
  problem.gain(0, 0) = 4.0;
  problem.gain(0, 1) = 1.0;
  EXPECT_DOUBLE_EQ(problem.gain_at(0, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(problem.gain_at(0, 5.0), 2.5);
  EXPECT_DOUBLE_EQ(problem.gain_at(0, 15.0), 0.5);
  EXPECT_DOUBLE_EQ(problem.gain_at(0, 20.0), 0.0);
  EXPECT_DOUBLE_EQ(problem.gain_at(0, INFINITY), 0.0);
}

TEST(TourProblem, RefusesSizesBeyondItsCapacity) {
  TourProblem problem(3, 2, kSamples);
  EXPECT_THROW(problem.resize(4, 1, 1.0, 1.0), UsageError);
  EXPECT_THROW(problem.resize(3, 3, 1.0, 1.0), UsageError);
  EXPECT_THROW(problem.resize(3, 0, 1.0, 1.0), UsageError);
  EXPECT_THROW(problem.resize(3, 2, 0.0, 1.0), UsageError);
  EXPECT_THROW(problem.resize(3, 2, 1.0, -1.0), UsageError);
  EXPECT_NO_THROW(problem.resize(3, 2, 1.0, 0.0));
}

}  // namespace
}  // namespace vantage::planner
