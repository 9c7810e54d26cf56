#include <random>

#include <benchmark/benchmark.h>

#include "planner/tour/tour_planner.hpp"

// Measures the decision time of a tour in a field of 200 × 200 m with the given number of targets.
// Arguments: targets, robots.

namespace vantage::planner {
namespace {

SearchProblem far_problem(int targets, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> place_m(-100.0, 100.0);
  std::uniform_real_distribution<double> variance(0.1, 20.0);
  SearchProblem problem;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = 10.0;
  sensor.range_min_m = 0.1;
  problem.sensors = {sensor};
  for (int i = 0; i < targets; ++i) {
    SearchTarget target;
    target.model = {models::TargetKind::kDoubleIntegrator, 2, 0.001};
    target.prior.mean = Eigen::Vector4d(place_m(rng), place_m(rng), 0.0, 0.0);
    target.prior.covariance =
        Eigen::Vector4d(variance(rng), variance(rng), 0.05, 0.05).asDiagonal();
    problem.targets.push_back(target);
  }
  return problem;
}

std::vector<FixedTeammate> teammates(int count) {
  std::vector<FixedTeammate> team(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    team[static_cast<std::size_t>(i)].trajectory.start = {25.0 * i - 80.0, 40.0, 0.0};
  }
  return team;
}

void plan_tour(benchmark::State& state) {
  constexpr std::uint64_t kProblems = 20;
  const int targets = static_cast<int>(state.range(0));
  std::vector<SearchProblem> problems;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    problems.push_back(far_problem(targets, seed));
  }
  const std::vector<FixedTeammate> team = teammates(static_cast<int>(state.range(1)) - 1);
  TourPlanner planner(targets);
  std::size_t next = 0;
  std::int64_t work_nodes = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(planner.plan(problems[next], team, {120.0, 0.3, 1.0}));
    work_nodes = std::max(work_nodes, planner.solver().work_nodes());
    next = (next + 1) % problems.size();
  }
  state.counters["most_visits"] = static_cast<double>(work_nodes);
}
BENCHMARK(plan_tour)->ArgsProduct({{20, 100}, {1, 4, 8}})->Unit(benchmark::kMillisecond);

void tabulate_terminal_value(benchmark::State& state) {
  const SearchProblem problem = far_problem(static_cast<int>(state.range(0)), 1);
  TourPlanner planner(static_cast<int>(state.range(0)));
  planner.plan(problem, {}, {120.0, 0.3, 1.0});
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(planner.terminal_value());
  }
}
BENCHMARK(tabulate_terminal_value)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vantage::planner

BENCHMARK_MAIN();
