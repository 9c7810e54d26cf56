#include <cmath>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/check.hpp"
#include "test/bench/best_costs.hpp"
#include "test/bench/study_run.hpp"
#include "test/bench/study_table.hpp"
#include "test/bench/tracking_family.hpp"

// Compares planners at each budget of CPU time with the best known cost, on a hundred problems of
// the tracking family and any given problem files. The list of best costs is kept in the
// repository, and its costs only decrease.

namespace vantage::bench {
namespace {

using tools::PlanningProblem;

struct Arguments {
  std::vector<std::string> files;
  std::vector<std::string> methods = {"beam", "arvi", "rvi", "greedy"};
  std::vector<double> budgets_s = {0.001, 0.01, 0.1};
  std::string best_path = "test/bench/best_costs.csv";
  std::string csv_path;
  std::string label;
  std::size_t problems = 100;
  std::size_t first = 0;
  double fov_deg = 94.0;
  std::uint64_t first_seed = 1;
  std::size_t memory_mb = 400;
  planner::BeamOptions beam;
  bool each = false;
};

// Throws if the list was edited or made for another family. The direct recursion loses eight digits
// at a measurement from 2 mm, which leaves errors of about 1e-5. The tolerance is therefore 1e-4.
void verify_best_costs(const BestCosts& best, const std::vector<PlanningProblem>& problems) {
  for (const PlanningProblem& drawn : problems) {
    const BestCosts::Entry* entry = best.find(drawn.name);
    if (entry == nullptr) {
      continue;
    }
    const double score = score_of(drawn.problem, entry->controls);
    if (!(std::abs(score - entry->cost) < 1e-4)) {
      throw StartupError(fmt::format("{}: listed at {}, but its controls score {}", drawn.name,
                                     entry->cost, score));
    }
  }
}

void study(const Arguments& arguments) {
  std::vector<PlanningProblem> problems = hundred_problems(arguments.fov_deg, arguments.first_seed);
  problems.erase(problems.begin(), problems.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                          arguments.first, problems.size())));
  problems.resize(std::min(problems.size(), arguments.problems));
  for (const std::string& path : arguments.files) {
    problems.push_back(tools::load_problem(path));
  }
  BestCosts best(arguments.best_path);
  verify_best_costs(best, problems);
  std::vector<StudyRun> runs;
  for (const std::string& name : arguments.methods) {
    // All problems use one search object, with capacity for 25 targets.
    planner::SearchCapacity capacity =
        planner::capacity_for(planner::algorithm_called(name), hundred_problems().back().problem,
                              arguments.memory_mb << 20, planner::nodes_within(5.0));
    for (const PlanningProblem& drawn : problems) {
      capacity.targets_max =
          std::max(capacity.targets_max, static_cast<int>(drawn.problem.targets.size()));
      capacity.horizon_max = std::max(capacity.horizon_max, drawn.problem.horizon_steps);
    }
    const StudyMethod method = make_method(name, arguments.beam, capacity);
    for (const PlanningProblem& drawn : problems) {
      double nodes_per_s = 4e6;
      for (const double budget_s : arguments.budgets_s) {
        StudyRun run = run_within(drawn, method, budget_s, nodes_per_s);
        if (std::isfinite(run.cost)) {
          best.offer(drawn.name,
                     {run.cost, arguments.label.empty() ? name : arguments.label, run.controls});
        }
        runs.push_back(std::move(run));
      }
    }
    best.save();
  }
  if (arguments.each) {
    for (const StudyRun& run : runs) {
      fmt::print("{:14} {:8} {:>8} cost {:14.6f} bound {:14.4f} excess {:10.4f}\n", run.problem,
                 run.method, run.budget_s, run.cost, run.lower_bound,
                 run.cost - best.find(run.problem)->cost);
    }
  }
  const std::vector<StudyRow> rows = summarise(runs, best);
  fmt::print("{}", to_text(rows));
  if (!arguments.csv_path.empty()) {
    write_csv(arguments.csv_path, rows);
  }
}

}  // namespace
}  // namespace vantage::bench

int main(int argc, char** argv) {
  vantage::bench::Arguments arguments;
  CLI::App app{"Mean excess over the best known costs, per method and budget of CPU time."};
  app.add_option("problems", arguments.files, "problem files besides the hundred");
  app.add_option("--methods", arguments.methods, "which algorithms of `vantage plan`")
      ->delimiter(',');
  app.add_option("--budgets-s", arguments.budgets_s, "CPU seconds, ascending")->delimiter(',');
  app.add_option("--best", arguments.best_path, "list of best known costs, kept up to date")
      ->capture_default_str();
  app.add_option("--label", arguments.label, "what to call the method in that list");
  app.add_option("--csv", arguments.csv_path, "write the table for the plots");
  app.add_option("--count", arguments.problems, "how many of the hundred");
  app.add_option("--first", arguments.first, "from which on");
  app.add_option("--first-seed", arguments.first_seed, "of the hundred: 1 are those reported");
  app.add_option("--fov-deg", arguments.fov_deg, "another field of view, the full angle");
  app.add_option("--first-width", arguments.beam.first_width, "of the beam");
  app.add_option("--growth", arguments.beam.growth, "of the beam");
  app.add_option("--cell-m", arguments.beam.cell_m, "of the beam");
  app.add_option("--cell-rad", arguments.beam.cell_rad, "of the beam");
  app.add_option("--shrink", arguments.beam.shrink, "of the beam");
  app.add_option("--persistence", arguments.beam.persistence, "of the beam");
  app.add_option("--alternation", arguments.beam.alternation, "of the beam");
  app.add_option("--breadth", arguments.beam.breadth, "of the beam");
  app.add_option("--anticipation", arguments.beam.anticipation, "of the beam");
  app.add_flag("--each", arguments.each, "one line a run, too");
  CLI11_PARSE(app, argc, argv);
  try {
    vantage::bench::study(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "planner_study: {}\n", error.what());
    return 2;
  }
  return 0;
}
