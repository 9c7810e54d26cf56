#include <memory>

#include <fmt/format.h>

#include "core/process.hpp"
#include "core/write_file.hpp"
#include "logs/picture/picture.hpp"
#include "planner/search/catalogue.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "tools/plan/plan_report.hpp"
#include "tools/plan/problem_json.hpp"
#include "tools/plan/solver.hpp"

namespace vantage::tools {
namespace {

struct PlanArguments {
  std::string problem;
  PlanRequest request;
  std::uint64_t seed = 0;
  std::string svg_path;
  bool as_json = false;
};

int run(const PlanArguments& arguments) {
  std::optional<DefaultSignalScope> preparing(std::in_place);
  if (!arguments.svg_path.empty()) {
    require_writable(arguments.svg_path);
  }
  PlanningProblem planning = load_problem(arguments.problem);
  planning.problem.seed = arguments.seed;
  Solver solver(arguments.request);
  solver.prepare(planning.problem);
  preparing.reset();
  PlanOutcome outcome = solver.solve(planning.problem, stop_requested);
  outcome.source = arguments.problem;

  if (arguments.as_json) {
    print_json(to_json(planning, outcome));
  } else {
    for (const std::string& line : to_lines(planning, outcome)) {
      print_line(line);
    }
    if (const std::string hint = hint_for(outcome); !hint.empty()) {
      print_line("hint      " + hint);
    }
  }
  if (!arguments.svg_path.empty()) {
    write_file(arguments.svg_path, draw_plan_picture(planning, outcome));
  }
  return is_complete(planning.problem, outcome.result) && !outcome.is_interrupted ? 0 : 1;
}

}  // namespace

// Long function: it adds the options one by one.
void add_plan_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "plan", "Solve one planning problem offline and bound its distance from the optimum.");
  auto arguments = std::make_shared<PlanArguments>();
  command->add_option("problem", arguments->problem, "problem file (JSON)")->required();
  std::vector<std::string> names = {"default"};
  std::string footer =
      "Algorithms:\n  default      the algorithm that was best for this kind of problem in the "
      "planner study\n";
  for (const planner::Algorithm& algorithm : planner::all_algorithms()) {
    names.emplace_back(algorithm.name);
    footer += fmt::format("  {:11}  {}\n", algorithm.name, algorithm.what);
  }
  command
      ->add_option("--algorithm", arguments->request.algorithm,
                   "search algorithm, see the list below")
      ->check(one_of(names))
      ->capture_default_str();
  auto* budget = command
                     ->add_option("--budget-s", arguments->request.budget_s,
                                  "search time in seconds, excluding the allocation of memory "
                                  "(default: 1, unless --nodes is given)")
                     ->check(number_between(0.0, kLongestBudget_s));
  command
      ->add_option("--nodes", arguments->request.nodes,
                   "search nodes instead of a time limit; gives exactly the same result every time")
      ->check(number_between(1, 1e12))
      ->excludes(budget);
  command
      ->add_option("--epsilon", arguments->request.options.epsilon,
                   "tolerance of covariances when nodes are pruned, m²")
      ->check(non_negative_number())
      ->capture_default_str();
  command
      ->add_option("--delta", arguments->request.options.delta_m,
                   "maximum distance at which two poses count as crossing when nodes are pruned, m")
      ->check(non_negative_number())
      ->capture_default_str();
  command->add_option("--weight", arguments->request.options.weight, "weight of the heuristic, ≥ 1")
      ->check(number_between(1.0, 1e6))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "seed of random searches")
      ->check(seed_number())
      ->capture_default_str();
  command->add_option("--memory-mb", arguments->request.memory_mb, "memory limit of the search, MB")
      ->check(number_between(16, 1 << 20))
      ->capture_default_str();
  command->add_option("--svg", arguments->svg_path, "file for a picture of the plan (SVG)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      footer +
      "JSON: `states` are the T poses [x, y, yaw] after each step, without the start. `cost` and\n"
      "`lower_bound` are sums over t = 1 … T. Unknown and infinite values are null (epsilon and\n"
      "delta are infinite before the first finite pass). Schema: docs/guide/planning-problems.md.\n"
      "Ctrl-C and SIGTERM end the search at once; the best plan so far is printed.\n"
      "Exit code 0: found a plan of T steps; 1: found none, or interrupted (see `stop_reason`);\n"
      "2: the problem file is invalid.\n"
      "Examples:\n"
      "  vantage plan problem.json --budget-s 0.1 --json\n"
      "  vantage plan problem.json --algorithm rvi --epsilon 1 --delta 0.5 --svg plan.svg\n"
      "  vantage plan problem.json --nodes 100000");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
