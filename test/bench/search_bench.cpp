#include <limits>

#include <benchmark/benchmark.h>

#include "planner/search/arvi.hpp"
#include "test/bench/dense_table.hpp"
#include "test/bench/field_problem.hpp"

// Measures time (ns) and memory (bytes) per node of the searches on the field family; CPU time of
// one core. Each iteration uses another of eight problems, so that the branch predictor cannot
// learn one problem; counters are means over the eight. Then compares the engine with a dense
// reference. On a busy machine use the minimum of --benchmark_repetitions=9;
// --benchmark_filter=NONE prints the table alone.

namespace vantage::bench {
namespace {

constexpr std::uint64_t kProblems = 8;

void run(benchmark::State& state, const planner::ReducedOptions& options, int horizon_steps,
         const Deadline& deadline) {
  const int targets = static_cast<int>(state.range(0));
  std::vector<planner::SearchProblem> problems;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    problems.push_back(field_problem(targets, horizon_steps, seed));
  }
  planner::ReducedValueIteration search({400'000, 8'000'000, targets, 16, 1});
  double nodes = 0.0;
  double work = 0.0;
  double bytes = 0.0;
  double cost = 0.0;
  for (const planner::SearchProblem& problem : problems) {
    const planner::SearchResult& result = search.plan(problem, options, deadline);
    nodes += static_cast<double>(result.nodes_generated) / kProblems;
    work += static_cast<double>(result.work_nodes) / kProblems;
    bytes += static_cast<double>(result.peak_bytes) / kProblems;
    cost += result.cost / kProblems;
  }
  std::int64_t timed_nodes = 0;
  std::size_t next = 0;
  for (auto iteration : state) {
    timed_nodes +=
        search.plan(problems[next++ % problems.size()], options, deadline).nodes_generated;
  }
  using benchmark::Counter;
  state.counters["nodes"] = nodes;
  state.counters["work_per_node"] = work / nodes;
  state.counters["time_per_node"] =
      Counter(static_cast<double>(timed_nodes), Counter::kIsRate | Counter::kInvert);
  state.counters["bytes_per_node"] = bytes / nodes;
  state.counters["mean_cost"] = cost;
}

void forward_value_iteration(benchmark::State& state) {
  planner::ReducedOptions options;
  options.search = planner::ReducedSearch::kExhaustive;
  run(state, options, 5, Deadline::never());
}

void reduced_value_iteration(benchmark::State& state) {
  planner::ReducedOptions options;
  options.search = planner::ReducedSearch::kSinglePass;
  options.epsilon = std::numeric_limits<double>::infinity();
  options.delta_m = 0.663;
  options.yaw_weight_m_per_rad = 0.0;  // compares positions only, like the reference
  run(state, options, 12, Deadline::never());
}

void anytime_reduced(benchmark::State& state) {
  run(state, {}, 12, Deadline::nodes(state.range(1)));
}

BENCHMARK(forward_value_iteration)
    ->Arg(1)
    ->Arg(9)
    ->Arg(25)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(reduced_value_iteration)->Arg(1)->Arg(9)->Arg(25)->Unit(benchmark::kMillisecond);
BENCHMARK(anytime_reduced)
    ->ArgsProduct({{1, 9, 25}, {1'000, 100'000}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  vantage::bench::print_dense_table();
  return 0;
}
