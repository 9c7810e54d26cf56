#include <exception>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/cpu_time.hpp"
#include "experiments/decisions/energy_trial.hpp"
#include "planner/decision/coordinate_descent.hpp"
#include "planner/decision/distributed_local_search.hpp"
#include "planner/decision/resilient.hpp"
#include "planner/decision/team_bound.hpp"

// Measures how the team's algorithms scale with the team: n robots and n targets, decided by one
// thread. Reports CPU time, and J compared with an upper bound of the value of any choice.

namespace vantage::bench {
namespace {

struct Arguments {
  std::vector<int> robots = {10, 20, 50, 100};
  std::uint64_t seed = 1;
  double budget_s = 0.5;
};

// Sets all prices to 1. The reference uses prices 1 … n, with which most of a hundred robots would
// not move.
void make_prices_equal(planner::TeamProblem& team) {
  double price = 1.0;
  for (std::vector<planner::Candidate>& of_robot : team.candidates) {
    for (planner::Candidate& candidate : of_robot) {
      candidate.energy_cost /= price;
    }
    price += 1.0;
  }
}

void run_one(int n, const Arguments& arguments, planner::ReducedValueIteration& search) {
  double then_s = thread_cpu_s();
  const auto lap_s = [&] {
    const double now_s = thread_cpu_s();
    const double lap = now_s - then_s;
    then_s = now_s;
    return lap;
  };
  experiments::EnergyTrial trial = experiments::draw_energy_trial(n, arguments.seed, {}, search);
  const double drawn_s = lap_s();
  make_prices_equal(trial.team);
  lap_s();
  const planner::TeamOracle oracle(trial.team);
  const double alone_s = lap_s();
  fmt::print("{} robots, {} targets, N = {}: trajectories {:.3f} s, each alone {:.4f} s\n", n, n,
             oracle.candidate_count(), drawn_s, alone_s);
  const auto row = [&](const std::string& name,
                       const std::function<planner::TeamDecision()>& decide) {
    lap_s();
    const planner::TeamDecision decision = decide();
    const double decided_s = lap_s();
    const double bound = value_bound(oracle, decision.choice);
    const double bound_s = lap_s();
    fmt::print("  {:28} {:>9.4f} s {:>9} calls  J {:>8.2f}  bound {:>8.2f} ({:.4f} s){}\n", name,
               decided_s, decision.oracle_calls, decision.value, bound, bound_s,
               decision.finished ? "" : "  cut short");
  };
  const auto deadline = [&] {
    return Deadline::at(monotonic_ns() + static_cast<std::int64_t>(1e9 * arguments.budget_s));
  };
  row("greedy", [&] { return planner::greedy(oracle); });
  row("coordinate descent, a turn",
      [&] { return planner::coordinate_descent(oracle, {}, deadline()); });
  row("coordinate descent to the end", [&] {
    return planner::coordinate_descent(oracle, {{}, 100, true}, deadline());
  });
  row("distributed local search",
      [&] { return planner::distributed_local_search(oracle, {}, deadline()); });
  row(fmt::format("robust, {} attacked", n / 5), [&] {
    return planner::plan_resiliently(oracle, n / 5, planner::SubSolver::kCoordinateDescent);
  });
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"CPU time of team decisions against the number of robots."};
  try {
    app.add_option("--robots", arguments.robots, "sizes of teams")->delimiter(',');
    app.add_option("--seed", arguments.seed)->capture_default_str();
    app.add_option("--budget-s", arguments.budget_s, "of each decision that takes a deadline")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    vantage::planner::ReducedValueIteration search({2'000'000, 60'000'000, 128, 16, 1});
    for (const int n : arguments.robots) {
      vantage::bench::run_one(n, arguments, search);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "team_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
