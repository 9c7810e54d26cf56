#include "test/bench/search_tree_data.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

#include <fmt/format.h>

#include "core/check.hpp"
#include "planner/search/heuristic.hpp"

namespace vantage::bench {
namespace {

std::ofstream opened(const std::string& path) {
  std::ofstream file(path);
  if (!file) {
    throw StartupError(path + ": cannot be written");
  }
  return file;
}

void write_motion(std::ofstream& file, const planner::SearchProblem& problem, const Pose2& from,
                  int control, int depth) {
  constexpr int kPieces = 4;
  for (int k = 0; k <= kPieces; ++k) {
    const Pose2 at = models::step_unicycle(
        from, problem.controls[static_cast<std::size_t>(control)], problem.step_s * k / kPieces);
    file << fmt::format("{:.4f} {:.4f} {}\n", at.x_m, at.y_m, depth);
  }
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

void write_tree(const std::string& path, const planner::SearchProblem& problem,
                const planner::Tree& tree, const planner::SearchResult& result,
                std::size_t nodes_max) {
  std::ofstream file = opened(path);
  const std::size_t count = std::min(nodes_max, tree.node_count());
  for (planner::NodeId id = 1; id < count; ++id) {
    const planner::Node& node = tree[id];
    write_motion(file, problem, tree[node.parent].world_from_body, node.control, node.depth);
    file << '\n';
  }
  file << '\n';
  Pose2 from = problem.start;
  for (std::size_t t = 0; t < result.controls.size(); ++t) {
    write_motion(file, problem, from, result.controls[t], static_cast<int>(t) + 1);
    from = result.poses[t];
  }
}

void write_heat_map(const std::string& path, const planner::SearchProblem& problem,
                    double resolution_m) {
  std::ofstream file = opened(path);
  const auto targets = static_cast<int>(problem.targets.size());
  planner::BeliefTable beliefs(targets, problem.horizon_steps);
  beliefs.reset(problem);
  planner::InformationHeuristic heuristic(targets, problem.horizon_steps);
  heuristic.reset(problem, beliefs);
  const models::Rectangle& bounds = problem.world->bounds;
  for (double y_m = bounds.min_m.y() + 0.5 * resolution_m; y_m < bounds.max_m.y();
       y_m += resolution_m) {
    for (double x_m = bounds.min_m.x() + 0.5 * resolution_m; x_m < bounds.max_m.x();
         x_m += resolution_m) {
      if (models::clearance_m(*problem.world, {x_m, y_m}) <= 0.0) {
        file << "nan ";
        continue;
      }
      file << fmt::format("{:.4f} ", heuristic.cost_to_go({x_m, y_m, 0.0}, 0, {}));
    }
    file << '\n';
  }
}

}  // namespace vantage::bench
