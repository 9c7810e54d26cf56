#include "test/bench/dense_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/cpu_time.hpp"
#include "planner/search/arvi.hpp"
#include "test/bench/dense_reference.hpp"
#include "test/bench/field_problem.hpp"

namespace vantage::bench {
namespace {

struct Row {
  int targets;
  int steps;
  int obstacles;
  int dense_steps;  ///< 0: too large for the dense reference
};

constexpr Row kRows[] = {
    {1, 5, 0, 4},  {9, 5, 0, 2},  {25, 5, 0, 2},  {100, 5, 0, 1}, {1000, 5, 0, 0},
    {25, 3, 0, 2}, {25, 4, 0, 2}, {25, 5, 20, 2}, {25, 5, 60, 2}, {1, 5, 60, 4},
};
constexpr std::uint64_t kDenseProblems = 8;

template <class Work>
double least_cpu_s(int repetitions, const Work& work) {
  double least_s = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const double begin_s = thread_cpu_s();
    work();
    least_s = std::min(least_s, thread_cpu_s() - begin_s);
  }
  return least_s;
}

void print_row(const Row& row, planner::ReducedValueIteration& search) {
  planner::ReducedOptions exhaustive;
  exhaustive.search = planner::ReducedSearch::kExhaustive;
  double engine_s = 0.0;
  double nodes = 0.0;
  double bytes = 0.0;
  for (std::uint64_t seed = 0; seed < kDenseProblems; ++seed) {
    const planner::OwnedProblem owned =
        obstructed_problem(row.targets, row.steps, row.obstacles, seed);
    engine_s += least_cpu_s(15, [&] { search.plan(owned.problem, exhaustive, Deadline::never()); });
    const planner::SearchResult& result = search.plan(owned.problem, exhaustive, Deadline::never());
    nodes += static_cast<double>(result.nodes_generated);
    bytes += static_cast<double>(result.peak_bytes);
  }
  std::fprintf(stderr, "%5d %2d %4d %9.0f %8.2f %7.1f %7.1f %8.2f", row.targets, row.steps,
               row.obstacles, nodes / kDenseProblems, 1e3 * engine_s / kDenseProblems,
               1e9 * engine_s / nodes, bytes / nodes, 1e-6 * nodes / engine_s);
  if (row.dense_steps == 0) {
    std::fprintf(stderr, "        –\n");
    return;
  }
  const planner::OwnedProblem owned =
      obstructed_problem(row.targets, row.dense_steps, row.obstacles, 0);
  DenseResult dense;
  const double dense_s = least_cpu_s(2, [&] { dense = dense_value_iteration(owned.problem); });
  const planner::SearchResult& same = search.plan(owned.problem, exhaustive, Deadline::never());
  const double dense_nodes_per_s = static_cast<double>(dense.nodes) / dense_s;
  std::fprintf(stderr, " %8d %11.0f %9.0f %9.1e%s\n", row.dense_steps, dense_nodes_per_s,
               nodes / engine_s / dense_nodes_per_s, std::abs(same.cost - dense.cost),
               dense.nodes == same.nodes_generated ? "" : "  NOT THE SAME NODES");
  std::fflush(stderr);
}

}  // namespace

void print_dense_table() {
  std::fprintf(
      stderr,
      "\nForward value iteration, engine beside dense joint covariances (CPU time)\n"
      "                             engine                            dense reference\n"
      "    M  T  obs     nodes       ms ns/node  B/node  Mnode/s        T      node/s     ratio  "
      "|Δcost|\n");
  planner::ReducedValueIteration search({120'000, 4'000'000, 1'000, 16, 1});
  for (const Row& row : kRows) {
    print_row(row, search);
  }
}

}  // namespace vantage::bench
