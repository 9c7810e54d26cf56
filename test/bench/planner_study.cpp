#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "planner/search/beam.hpp"
#include "test/bench/tracking_family.hpp"
#include "tools/plan/algorithms.hpp"

// Which planner is best at which budget: a hundred problems of the tracking family (and any problem
// files given), each algorithm at each budget of CPU time, against the best cost that anything has
// ever reached. The machine may be busy, so budgets are of nodes, calibrated per run until the CPU
// time of the search agrees with the budget.

namespace vantage::bench {
namespace {

using tools::PlanningProblem;
using Costs = std::map<std::string, double>;

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Run {
  double cost = std::numeric_limits<double>::infinity();
  double cpu_s = 0.0;
};

/// The best cost within `budget_s` of CPU time: the longest run that fits into it.
template <class Plan>
Run run_within(const PlanningProblem& drawn, double budget_s, double& nodes_per_s,
               const Plan& plan) {
  Run best;
  double nodes = nodes_per_s * budget_s;
  for (int tries = 0; tries < 5; ++tries) {
    const double start_s = thread_cpu_s();
    const planner::SearchResult& result =
        plan(drawn.problem, Deadline::nodes(std::max<std::int64_t>(1, std::llround(nodes))));
    const double cpu_s = thread_cpu_s() - start_s;
    const bool is_complete = result.found && result.moving_steps == drawn.problem.horizon_steps;
    if (is_complete && cpu_s <= 1.02 * budget_s && result.cost < best.cost) {
      best = {result.cost, cpu_s};
    }
    nodes_per_s = static_cast<double>(result.work_nodes) / cpu_s;
    if (result.stop_reason != planner::StopReason::kDeadline ||
        (cpu_s > 0.93 * budget_s && cpu_s <= 1.02 * budget_s)) {
      break;
    }
    nodes *= std::clamp(0.98 * budget_s / cpu_s, 0.2, 20.0);
  }
  return best;
}

Costs read_costs(const std::string& path) {
  Costs costs;
  std::ifstream file(path);
  if (file) {
    costs = nlohmann::json::parse(file).get<Costs>();
  }
  return costs;
}

void write_costs(const std::string& path, const Costs& costs) {
  std::ofstream(path) << nlohmann::json(costs).dump(1) << '\n';
}

struct Arguments {
  std::vector<std::string> files;
  std::vector<std::string> algorithms = {"beam", "arvi", "greedy"};
  std::vector<double> budgets_s = {0.001, 0.01, 0.1, 1.0};
  std::string best_path;
  std::size_t problems = 100;
  std::size_t first = 0;
  double half_fov_deg = 94.0;
  std::size_t memory_mb = 400;
  planner::BeamOptions beam;
  bool each = false;
};

void study(const Arguments& arguments) {
  std::vector<PlanningProblem> problems = hundred_problems(arguments.half_fov_deg);
  problems.erase(problems.begin(), problems.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                          arguments.first, problems.size())));
  problems.resize(std::min(problems.size(), arguments.problems));
  for (const std::string& path : arguments.files) {
    problems.push_back(tools::load_problem(path));
  }
  Costs best = read_costs(arguments.best_path);
  // results[algorithm][budget][problem]
  std::map<std::string, std::vector<std::vector<Run>>> results;
  for (const std::string& name : arguments.algorithms) {
    auto& runs = results[name];
    runs.assign(arguments.budgets_s.size(), {});
    for (const PlanningProblem& drawn : problems) {
      const planner::SearchCapacity capacity =
          tools::capacity_for(tools::algorithm_called(name), drawn.problem,
                              arguments.memory_mb << 20, tools::nodes_within(5.0));
      static std::map<std::string, std::unique_ptr<tools::Search>> searches;
      static std::unique_ptr<planner::RefiningBeam> beam;
      const auto plan = [&](const planner::SearchProblem& problem,
                            const Deadline& deadline) -> const planner::SearchResult& {
        if (name == "beam") {
          return beam->plan(problem, arguments.beam, deadline);
        }
        return searches[name]->search(problem, deadline);
      };
      // One object for all problems: 25 targets are the most.
      planner::SearchCapacity common = capacity;
      common.targets_max = std::max(common.targets_max, 25);
      if (name == "beam" && beam == nullptr) {
        beam = std::make_unique<planner::RefiningBeam>(common);
      } else if (name != "beam" && searches[name] == nullptr) {
        searches[name] = tools::algorithm_called(name).make(common, {});
      }
      double nodes_per_s = 2e6;
      for (std::size_t b = 0; b < arguments.budgets_s.size(); ++b) {
        runs[b].push_back(run_within(drawn, arguments.budgets_s[b], nodes_per_s, plan));
        const auto [known, is_new] = best.emplace(drawn.name, runs[b].back().cost);
        known->second = std::min(known->second, runs[b].back().cost);
      }
    }
    if (!arguments.best_path.empty()) {
      write_costs(arguments.best_path, best);
    }
  }

  fmt::print("{:8} {:>8} {:>10} {:>10} {:>10} {:>8} {:>8} {:>9}\n", "", "budget_s", "mean", "p90",
             "max", "≤ 0.01", "no plan", "cpu_s");
  for (const std::string& name : arguments.algorithms) {
    for (std::size_t b = 0; b < arguments.budgets_s.size(); ++b) {
      std::vector<double> excess;
      std::size_t without = 0;
      double cpu_s = 0.0;
      for (std::size_t p = 0; p < problems.size(); ++p) {
        const Run& run = results[name][b][p];
        cpu_s += run.cpu_s;
        if (!std::isfinite(run.cost)) {
          ++without;
          continue;
        }
        excess.push_back(run.cost - best[problems[p].name]);
        if (arguments.each) {
          fmt::print("  {:12} {:8} {:>8} {:14.6f} excess {:10.4f}\n", problems[p].name, name,
                     arguments.budgets_s[b], run.cost, excess.back());
        }
      }
      if (excess.empty()) {
        continue;
      }
      std::sort(excess.begin(), excess.end());
      double sum = 0.0;
      for (const double e : excess) {
        sum += e;
      }
      const auto count = static_cast<double>(excess.size());
      fmt::print("{:8} {:>8} {:>10.4f} {:>10.4f} {:>10.4f} {:>8} {:>8} {:>9.5f}\n", name,
                 arguments.budgets_s[b], sum / count,
                 excess[static_cast<std::size_t>(0.9 * (count - 1.0))], excess.back(),
                 std::count_if(excess.begin(), excess.end(), [](double e) { return e <= 0.01; }),
                 without, cpu_s / static_cast<double>(problems.size()));
    }
  }
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"Mean excess over the best known costs, per algorithm and budget of CPU time."};
  app.add_option("problems", arguments.files, "problem files besides the hundred");
  app.add_option("--algorithms", arguments.algorithms, "which")->delimiter(',');
  app.add_option("--budgets-s", arguments.budgets_s, "CPU seconds, ascending")->delimiter(',');
  app.add_option("--best", arguments.best_path, "JSON list of best known costs, kept up to date");
  app.add_option("--count", arguments.problems, "how many of the hundred");
  app.add_option("--first", arguments.first, "from which on");
  app.add_option("--half-fov-deg", arguments.half_fov_deg, "another field of view");
  app.add_option("--first-width", arguments.beam.first_width, "of the beam");
  app.add_option("--growth", arguments.beam.growth, "of the beam");
  app.add_option("--cell-m", arguments.beam.cell_m, "of the beam");
  app.add_option("--cell-rad", arguments.beam.cell_rad, "of the beam");
  app.add_option("--shrink", arguments.beam.shrink, "of the beam");
  app.add_option("--persistence", arguments.beam.persistence, "of the beam");
  app.add_option("--alternation", arguments.beam.alternation, "of the beam");
  app.add_option("--breadth", arguments.beam.breadth, "of the beam");
  app.add_option("--anticipation", arguments.beam.anticipation, "of the beam");
  app.add_flag("--each", arguments.each, "one line a problem, too");
  CLI11_PARSE(app, argc, argv);
  vantage::bench::study(arguments);
  return 0;
}
