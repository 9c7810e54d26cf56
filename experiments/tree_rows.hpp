#pragma once

#include <map>
#include <string>

#include "experiments/sweep/sweep.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/tree.hpp"

// Search trees and heuristic values as rows, and the files that gnuplot draws.

namespace vantage::experiments {

/// Returns the cost per step of an average path in the tree. It is the mean of g(n)/t over the
/// nodes of each depth t = 1 … T − 1, averaged over the depths. Thus a tree with many deep nodes
/// has no advantage. Leaves are excluded, because best-first searches keep none.
double cost_per_path(const planner::Tree& tree, int horizon_steps);

/// Adds the motions of the tree's first `nodes_max` nodes, and of the plan, to the table "motions".
void add_tree_rows(UnitRows& rows, const planner::SearchProblem& problem, const planner::Tree& tree,
                   const planner::SearchResult& result, std::size_t nodes_max);

/// Adds h(x, y) of the root's beliefs over the world by Thm 6 to the table "heat_map". Values
/// inside obstacles are included; the figures draw the obstacles over them.
void add_heat_map_rows(UnitRows& rows, const planner::SearchProblem& problem, double resolution_m);

/// Returns tree_PROBLEM_METHOD.txt (polylines "x y depth", the plan as a second block) for each
/// setting "PROBLEM,METHOD" with motions, and heat_map.txt.
std::map<std::string, std::string> tree_files(const SweepPlan& plan, const Tables& tables);

}  // namespace vantage::experiments
