#pragma once

#include <map>
#include <string>

#include "experiments/sweep/sweep.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/tree.hpp"

// Search trees and what a heuristic says, as rows and as the files that gnuplot draws.

namespace vantage::experiments {

/// What an average path in the tree costs a step: the mean of g(n)/t over the nodes of each depth t
/// = 1 … T − 1, and the mean of these, so that a tree with many deep nodes is not the better for
/// it. The leaves do not count: best-first searches keep none.
double cost_per_path(const planner::Tree& tree, int horizon_steps);

/// Adds the motions of the tree's first `nodes_max` nodes, and of the plan, to the table "motions".
void add_tree_rows(UnitRows& rows, const planner::SearchProblem& problem, const planner::Tree& tree,
                   const planner::SearchResult& result, std::size_t nodes_max);

/// Adds h(x, y) of the root's beliefs over the world by Thm 6 to the table "heat_map"; inside
/// obstacles as well, which the pictures cover.
void add_heat_map_rows(UnitRows& rows, const planner::SearchProblem& problem, double resolution_m);

/// tree_PROBLEM_METHOD.txt (polylines "x y depth", the plan's as a second block) for each setting
/// "PROBLEM,METHOD" with motions, and heat_map.txt.
std::map<std::string, std::string> tree_files(const SweepPlan& plan, const Tables& tables);

}  // namespace vantage::experiments
