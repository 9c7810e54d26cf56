#include "experiments/mapping/tree_rows.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "planner/search/heuristic.hpp"

namespace vantage::experiments {
namespace {

// Returns a motion as a row with four straight segments: "plan,3,x y x y x y".
std::string motion_row(const char* part, const planner::SearchProblem& problem, const Pose2& from,
                       int control, int depth) {
  constexpr int kPieces = 4;
  std::string row = fmt::format("{},{},", part, depth);
  for (int k = 0; k <= kPieces; ++k) {
    const Pose2 at = models::step_unicycle(
        from, problem.controls[static_cast<std::size_t>(control)], problem.step_s * k / kPieces);
    row += fmt::format("{}{:.3f} {:.3f}", k == 0 ? "" : " ", at.x_m, at.y_m);
  }
  return row;
}

// Returns the points of a motion, one per line.
std::string polyline(const Record& record) {
  std::string text;
  int spaces = 0;
  for (const char c : record.cells[2]) {
    const bool ends_point = c == ' ' && ++spaces % 2 == 0;
    text += ends_point ? " " + record.cells[1] + "\n" : std::string(1, c);
  }
  return text + " " + record.cells[1] + "\n";
}

}  // namespace

double cost_per_path(const planner::Tree& tree, int horizon_steps) {
  std::vector<double> sums(static_cast<std::size_t>(horizon_steps), 0.0);
  std::vector<double> counts(sums.size(), 0.0);
  for (planner::NodeId id = 0; id < tree.node_count(); ++id) {
    const planner::Node& node = tree[id];
    if (node.depth > 0 && node.depth < horizon_steps) {
      sums[node.depth] += node.cost / node.depth;
      counts[node.depth] += 1.0;
    }
  }
  double sum = 0.0;
  double depths = 0.0;
  for (std::size_t t = 1; t < sums.size(); ++t) {
    sum += counts[t] > 0.0 ? sums[t] / counts[t] : 0.0;
    depths += counts[t] > 0.0 ? 1.0 : 0.0;
  }
  return sum / std::max(1.0, depths);
}

void add_tree_rows(UnitRows& rows, const planner::SearchProblem& problem, const planner::Tree& tree,
                   const planner::SearchResult& result, std::size_t nodes_max) {
  std::vector<std::string>& motions = rows.tables["motions"];
  const std::size_t count = std::min(nodes_max, tree.node_count());
  for (planner::NodeId id = 1; id < count; ++id) {
    const planner::Node& node = tree[id];
    motions.push_back(
        motion_row("tree", problem, tree[node.parent].world_from_body, node.control, node.depth));
  }
  Pose2 from = problem.start;
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    motions.push_back(
        motion_row("plan", problem, from, result.controls[t], static_cast<int>(t) + 1));
    from = result.poses[t];
  }
}

void add_heat_map_rows(UnitRows& rows, const planner::SearchProblem& problem, double resolution_m) {
  const auto targets = static_cast<int>(problem.targets.size());
  planner::BeliefTable beliefs(targets, problem.horizon_steps);
  beliefs.reset(problem);
  planner::InformationHeuristic heuristic(targets, problem.horizon_steps);
  heuristic.reset(problem, beliefs);
  const models::Rectangle& bounds = problem.world->bounds;
  for (double y_m = bounds.min_m.y() + 0.5 * resolution_m; y_m < bounds.max_m.y();
       y_m += resolution_m) {
    std::string row;
    for (double x_m = bounds.min_m.x() + 0.5 * resolution_m; x_m < bounds.max_m.x();
         x_m += resolution_m) {
      row += fmt::format("{:.4f} ", heuristic.cost_to_go({x_m, y_m, 0.0}, 0, {}));
    }
    rows.tables["heat_map"].push_back(row);
  }
}

std::map<std::string, std::string> tree_files(const SweepPlan& plan, const Tables& tables) {
  std::map<std::string, std::string> files;
  std::string part;
  for (const Record& record : tables.at("motions")) {
    std::string name = "tree_" + plan.settings[record.unit.setting].cells + ".txt";
    std::replace(name.begin(), name.end(), ',', '_');
    std::string& file = files[name];
    if (!file.empty() && record.cells[0] != part) {
      file += '\n';  // separates two blocks
    }
    part = record.cells[0];
    file += polyline(record);
    if (part == "tree") {
      file += '\n';  // separates two lines
    }
  }
  for (const Record& record : tables.at("heat_map")) {
    files["heat_map.txt"] += record.cells[0] + "\n";
  }
  return files;
}

}  // namespace vantage::experiments
