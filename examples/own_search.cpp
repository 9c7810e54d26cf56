// Custom search: returns the cheapest of many random walks. Needs component planner (and Eigen).
#include <cstdio>
#include <random>

#include <vantage/planner/search/plan_path.hpp>

using namespace vantage::planner;

SearchResult best_walk(const SearchProblem& problem, int walks) {
  Expander expander(static_cast<int>(problem.targets.size()), problem.horizon_steps, 0);
  Tree tree(100, 10'000);  // capacity for one walk: number of nodes; doubles for beliefs
  expander.reset(problem);
  std::mt19937_64 rng(1);
  SearchResult best;
  for (int walk = 0; walk < walks; ++walk) {
    tree.clear();
    NodeId at = tree.add(expander.root());
    Children next;
    for (std::uint8_t t = 1; t <= problem.horizon_steps && expander.expand(tree, at, next); ++t) {
      if (next.count == 0)
        break;  // every control leads to a collision
      const std::size_t i = rng() % static_cast<std::size_t>(next.count);
      at = tree.add({next.world_from_body[i], next.cost[i], at, 0, kNoNode, next.control[i], t});
    }
    if (tree[at].depth == problem.horizon_steps && (!best.found || tree[at].cost < best.cost)) {
      best.found = true;
      best.cost = tree[at].cost;
      write_path(tree, at, problem.horizon_steps, best);
    }
  }
  return best;
}

int main() {
  SearchProblem problem{.controls = vantage::models::standard_primitives(), .sensors = {{}}};
  problem.targets.push_back(
      {{.q = 0.05}, {Eigen::Vector2d{6.0, 3.0}, Eigen::Matrix2d::Identity()}});
  const SearchResult plan = best_walk(problem, 2'000);
  std::printf("cost %.12f in %zu steps\n", plan.cost, plan.poses.size());
}
