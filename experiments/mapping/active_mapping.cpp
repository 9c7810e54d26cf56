#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "experiments/experiment.hpp"
#include "experiments/figures.hpp"
#include "experiments/mapping/landmark_problem.hpp"
#include "experiments/mapping/tree_rows.hpp"
#include "experiments/sweep/compare.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/astar.hpp"

namespace vantage::experiments {
namespace {

using planner::SearchProblem;
using planner::SearchResult;

constexpr int kStarts = 100;  // number of starts in the dissertation
constexpr std::array<double, 2> kBudgets_s = {0.01, 0.1};
constexpr double kProof_s = 1.0;  // s; planning time of A*; the dissertation uses 10 s
constexpr double kEpsilon = 1.0;  // as in Fig. 2.5
constexpr double kDelta_m = 0.1;
constexpr double kHeatMap_m = 0.05;

// A search and its rate in nodes per second, which converts time budgets into nodes. The reference
// machine is one core of a 2-core virtual machine with the release preset.
struct Method {
  const char* name;
  double nodes_per_s;
};
constexpr Method kAStar{"astar", 1.5e6};
constexpr Method kArvi{"arvi", 5.0e6};
constexpr Method kAegis{"aegis", 1.5e6};
constexpr std::array<Method, 3> kMethods = {kAStar, kArvi, kAegis};

// Limits of the trees in the figures.
struct Drawing {
  std::int64_t arvi_nodes = 4'000'000;
  std::int64_t moving_nodes = 20'000'000;
  std::size_t nodes_drawn = 20'000;
};

struct Searches {
  planner::BestFirstSearch best_first{{1'500'000, 20'000'000, 16, 16, 1}};
  planner::ReducedValueIteration reduced{{4'000'000, 60'000'000, 16, 16, 1}};

  const SearchResult& plan(const std::string& method, const SearchProblem& problem,
                           const Deadline& deadline) {
    if (method == "arvi" || method == "rvi") {
      planner::ReducedOptions options;
      options.keeps_leaves = true;  // the picture of the tree shows the leaves
      if (method == "rvi") {
        options.search = planner::ReducedSearch::kSinglePass;
        options.epsilon = kEpsilon;
        options.delta_m = kDelta_m;
      }
      return reduced.plan(problem, options, deadline);
    }
    planner::BestFirstOptions options;
    if (method == "aegis") {
      options.search = planner::BestFirst::kAegis;
      options.epsilon = kEpsilon;
      options.delta_m = kDelta_m;
    }
    return best_first.plan(problem, options, deadline);
  }
  [[nodiscard]] const planner::Tree& tree(const std::string& method) const {
    return method == "arvi" || method == "rvi" ? reduced.tree() : best_first.tree();
  }
};

// Returns the calling thread's searches. They are reused, because their 1 GB of memory takes longer
// to prepare than one search. Earlier searches do not affect later ones.
Searches& searches() {
  // The object is on the heap, because thread-local objects use stack space of every thread.
  thread_local const auto own = std::make_unique<Searches>();
  return *own;
}

int seen_by(const SearchProblem& problem, const std::vector<Pose2>& poses) {
  int seen = 0;
  for (const planner::SearchTarget& target : problem.targets) {
    const Eigen::Vector2d at_m = target.prior.mean.head<2>();
    const bool is_seen = std::any_of(poses.begin(), poses.end(), [&](const Pose2& pose) {
      return (pose.position_m() - at_m).norm() < problem.sensors[0].range_max_m &&
             models::line_of_sight(*problem.world, pose.position_m(), at_m);
    });
    seen += is_seen ? 1 : 0;
  }
  return seen;
}

// Returns the cost of a complete plan; +∞ if there is none.
double cost_of(const SearchProblem& problem, const SearchResult& result) {
  return result.found && result.moving_steps == problem.horizon_steps
             ? result.cost
             : std::numeric_limits<double>::infinity();
}

std::string plan_row(const SearchProblem& problem, const SearchResult& result,
                     const planner::Tree& tree) {
  return fmt::format("{:.4f},{:.4f},{:.4f},{:.6f},{:.6f},{:.6f},{},{},{}", problem.start.x_m,
                     problem.start.y_m, problem.start.yaw_rad, cost_of(problem, result),
                     result.lower_bound, cost_per_path(tree, problem.horizon_steps),
                     seen_by(problem, result.poses), result.nodes_expanded, tree.node_count());
}

UnitRows run_start(const Method& method, double budget_s, std::uint64_t seed) {
  const planner::OwnedProblem owned = random_start_problem(seed);
  const auto nodes = static_cast<std::int64_t>(method.nodes_per_s * budget_s);
  const SearchResult& result = searches().plan(method.name, owned.problem, Deadline::nodes(nodes));
  UnitRows rows;
  rows.tables["plans"] = {plan_row(owned.problem, result, searches().tree(method.name))};
  return rows;
}

UnitRows run_drawn(const planner::OwnedProblem& owned, const std::string& method,
                   std::int64_t nodes, const Drawing& drawing) {
  const SearchResult& result = searches().plan(method, owned.problem, Deadline::nodes(nodes));
  const planner::Tree& tree = searches().tree(method);
  UnitRows rows;
  rows.tables["plans"] = {plan_row(owned.problem, result, tree)};
  add_tree_rows(rows, owned.problem, tree, result, drawing.nodes_drawn);
  return rows;
}

// A setting and the function that runs it.
struct MappingCase {
  Setting setting;
  std::function<UnitRows(std::uint64_t seed)> run;
};

std::vector<MappingCase> all_cases(const Drawing& drawing) {
  std::vector<MappingCase> cases;
  const auto add = [&](const std::string& cells, bool is_once, auto run) {
    MappingCase of;
    of.setting.cells = cells;
    of.setting.is_once = is_once;
    of.run = run;
    cases.push_back(of);
  };
  for (const double budget_s : kBudgets_s) {
    for (const Method& method : kMethods) {
      add(fmt::format("free-{}s,{}", budget_s, method.name), false,
          [method, budget_s](std::uint64_t seed) { return run_start(method, budget_s, seed); });
    }
  }
  add(fmt::format("free-{}s,{}", kProof_s, kAStar.name), false,
      [](std::uint64_t seed) { return run_start(kAStar, kProof_s, seed); });
  for (const char* method : {"astar", "arvi", "aegis"}) {
    const std::int64_t nodes =
        std::string(method) == "arvi" ? drawing.arvi_nodes : drawing.moving_nodes;
    add(fmt::format("known,{}", method), true, [=](std::uint64_t) {
      return run_drawn(landmark_problem({3.0, 3.0, 0.0}), method, nodes, drawing);
    });
  }
  for (const char* method : {"rvi", "astar", "aegis"}) {
    add(fmt::format("moving,{}", method), true, [=](std::uint64_t) {
      return run_drawn(moving_target_problem(), method, drawing.moving_nodes, drawing);
    });
  }
  add("heat-map,bound", true, [](std::uint64_t) {
    UnitRows rows;
    add_heat_map_rows(rows, landmark_problem({3.0, 3.0, 0.0}).problem, kHeatMap_m);
    return rows;
  });
  return cases;
}

// Samples of all plans of one setting.
struct PlanSamples {
  Sample cost;
  Sample gap;
  Sample per_path;
  Sample seen;
  Sample expanded;
  int proven = 0;
};

std::map<std::string, PlanSamples> samples_of(const SweepPlan& plan, const Tables& tables) {
  std::map<std::string, PlanSamples> samples;
  for (const Record& record : tables.at("plans")) {
    PlanSamples& of = samples[plan.settings[record.unit.setting].cells];
    const double cost = record.number(3);
    if (!std::isfinite(cost)) {
      continue;  // no sequence of primitives from this start avoids the walls
    }
    of.cost.add(cost);
    of.gap.add(cost - record.number(4));
    of.per_path.add(record.number(5));
    of.seen.add(record.number(6));
    of.expanded.add(record.number(7));
    of.proven += record.number(4) >= cost ? 1 : 0;
  }
  return samples;
}

std::string places_of(const SearchProblem& problem) {
  std::string text;
  for (const planner::SearchTarget& target : problem.targets) {
    text += fmt::format("{} {}\n", target.prior.mean.x(), target.prior.mean.y());
  }
  return text;
}

void compare(const std::map<std::string, PlanSamples>& samples, Summary& summary) {
  const PlanSamples& astar = samples.at("free-0.1s,astar");
  const PlanSamples& arvi = samples.at("free-0.1s,arvi");
  const PlanSamples& long_astar = samples.at(fmt::format("free-{}s,astar", kProof_s));
  summary.compared = {
      compare_number("mean cost per path in the tree of A*, 0.1 s", astar.per_path, 2.67, "m²"),
      compare_number("mean cost per path in the tree of ARVI, 0.1 s", arvi.per_path, 3.14, "m²"),
      compare_claim(
          "order of the mean costs per path",
          astar.per_path.mean() < arvi.per_path.mean() ? "A* below ARVI" : "ARVI below A*",
          "A* below ARVI (caption; the text states the opposite)",
          astar.per_path.mean() < arvi.per_path.mean()),
      compare_claim("starts for which A* finds and proves the optimum",
                    fmt::format("{} of {} in {} s ({} in 0.1 s)", long_astar.proven,
                                long_astar.cost.size(), kProof_s, astar.proven),
                    "all, in less than 10 s",
                    static_cast<std::size_t>(long_astar.proven) == long_astar.cost.size()),
      compare_claim(
          "landmarks that the optimal plan from the known start observes",
          fmt::format("{:.0f} of 6 landmarks, cost {:.4f}, proven optimal: {}",
                      samples.at("known,astar").seen.mean(), samples.at("known,astar").cost.mean(),
                      samples.at("known,astar").proven == 1 ? "yes" : "no"),
          "six", samples.at("known,astar").seen.mean() == 6.0)};
}

Summary summarise(const SweepPlan& plan, const Tables& tables) {
  const std::map<std::string, PlanSamples> samples = samples_of(plan, tables);
  Summary summary;
  summary.files = tree_files(plan, tables);
  summary.files["landmarks.txt"] = places_of(landmark_problem({}).problem);
  summary.files["moving_target.txt"] = places_of(moving_target_problem().problem);
  std::string& csv = summary.files["summary.csv"];
  csv = "problem,method,plans,proven,cost,gap,cost_per_path,cost_per_path_ci95,seen,expanded\n";
  for (const auto& [cells, of] : samples) {
    csv += fmt::format("{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.3f},{:.1f}\n", cells,
                       of.cost.size(), of.proven, of.cost.mean(), of.gap.mean(), of.per_path.mean(),
                       of.per_path.half_interval(), of.seen.mean(), of.expanded.mean());
    summary.lines.push_back(fmt::format(
        "{}: {} plans, {} proven optimal, mean cost {:.4f} m², gap {:.4f}, {:.2f} landmarks seen",
        cells, of.cost.size(), of.proven, of.cost.mean(), of.gap.mean(), of.seen.mean()));
  }
  compare(samples, summary);
  summary.figure_script = active_mapping_figures();
  summary.figures = {"active-mapping-heat-map", "active-mapping-trees", "active-mapping-paths",
                     "active-mapping-moving"};
  summary.choices = {
      "The source does not state how the cost per path is normalised. Here: mean of g(n)/t over "
      "the nodes of each depth, then mean over the depths 1 … T − 1.",
      "Time budgets are converted to nodes at the reference machine's rate (see the settings); "
      "the source gives A* ten seconds and ARVI sixty.",
      "Starts from which every sequence of primitives comes too near to the wall are left out.",
      fmt::format(
          "AEGIS and RVI: ε = {:g}, δ = {:g} m, as in Fig. 2.5; the target is our own choice.",
          kEpsilon, kDelta_m)};
  return summary;
}

}  // namespace

Sweep active_mapping(const Extent& extent) {
  Drawing drawing;
  if (extent.is_smoke) {
    drawing = {100'000, 1'000'000, 1'000};
  }
  Sweep sweep;
  sweep.plan.setting_columns = "problem,method";
  const std::vector<MappingCase> cases = all_cases(drawing);
  for (const MappingCase& of : cases) {
    sweep.plan.settings.push_back(of.setting);
  }
  sweep.plan.trials = extent.trials_or(kStarts);
  sweep.plan.parameters = {{"arvi_nodes_drawn_from", std::to_string(drawing.arvi_nodes)},
                           {"moving_nodes", std::to_string(drawing.moving_nodes)},
                           {"nodes_drawn", std::to_string(drawing.nodes_drawn)}};
  for (const Method& method : kMethods) {
    sweep.plan.parameters[fmt::format("{}_nodes_per_s", method.name)] =
        fmt::format("{}", method.nodes_per_s);
  }
  sweep.plan.tables = {
      {"plans", "x_m,y_m,yaw_rad,cost,lower_bound,cost_per_path,seen,expanded,nodes"},
      {"motions", "part,depth,points_m"},
      {"heat_map", "cost_to_go"}};
  sweep.run = [cases](std::size_t setting, std::uint64_t seed) { return cases[setting].run(seed); };
  sweep.summarise = [plan = sweep.plan](const Tables& tables) { return summarise(plan, tables); };
  return sweep;
}

}  // namespace vantage::experiments
