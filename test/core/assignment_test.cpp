#include "core/assignment.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/random.hpp"

namespace vantage {
namespace {

double cost_of(const std::vector<double>& cost, std::span<const int> column, int columns) {
  double sum = 0.0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    sum += cost[i * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column[i])];
  }
  return sum;
}

// Returns the lowest cost over every choice of columns in every order.
double least_cost(const std::vector<double>& cost, int rows, int columns) {
  std::vector<int> order(static_cast<std::size_t>(columns));
  std::iota(order.begin(), order.end(), 0);
  double least = 1e300;
  do {
    least = std::min(
        least, cost_of(cost, std::span(order).first(static_cast<std::size_t>(rows)), columns));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(AssignmentSolver, MatchesExhaustiveSearch) {
  test::Random random(1);
  AssignmentSolver solver(6, 7);
  for (int trial = 0; trial < 300; ++trial) {
    const int columns = random.integer(1, 7);
    const int rows = random.integer(0, std::min(6, columns));
    const bool has_ties = random.coin();
    std::vector<double> cost(static_cast<std::size_t>(rows * columns));
    for (double& of : cost) {
      of = has_ties ? random.integer(-2, 2) : random.uniform(-5.0, 5.0);
    }
    const std::span<const int> column = solver.solve(cost, rows, columns);
    ASSERT_EQ(column.size(), static_cast<std::size_t>(rows));
    std::vector<int> sorted(column.begin(), column.end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_TRUE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
    EXPECT_NEAR(cost_of(cost, column, columns), least_cost(cost, rows, columns), 1e-12);
  }
}

TEST(AssignmentSolver, AvoidsForbiddenPairsIfOthersExist) {
  AssignmentSolver solver;
  const std::vector<double> cost = {1.0, 1e6, 2.0, 1.0, 1e6, 1e6};
  const std::span<const int> column = solver.solve(cost, 2, 3);
  EXPECT_EQ(column[0], 2);
  EXPECT_EQ(column[1], 0);
}

TEST(AssignmentSolver, RefusesMoreRowsThanColumns) {
  AssignmentSolver solver;
  EXPECT_THROW(static_cast<void>(solver.solve(std::vector<double>(2), 2, 1)), UsageError);
}

}  // namespace
}  // namespace vantage
