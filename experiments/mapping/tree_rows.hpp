#pragma once

#include <map>
#include <string>

#include "experiments/sweep/sweep.hpp"
#include "planner/problem/problem.hpp"
#include "planner/search/tree.hpp"

// Conversion of search trees and heuristic values to table rows, and to the input files of gnuplot.

namespace vantage::experiments {

/// Returns the cost per step of an average path in the tree. It is the mean of g(n)/t over the
/// nodes of each depth t = 1 … T − 1, averaged over the depths. The average over depths prevents an
/// advantage of trees with many deep nodes. Leaves are excluded, because best-first searches store
/// none.
double cost_per_path(const planner::Tree& tree, int horizon_steps);

/// Adds the motions of the tree's first `nodes_max` nodes, and of the plan, to the table "motions".
void add_tree_rows(UnitRows& rows, const planner::SearchProblem& problem, const planner::Tree& tree,
                   const planner::SearchResult& result, std::size_t nodes_max);

/// Adds h(x, y) of the root's beliefs over the world by Thm 6 to the table "heat_map". Values
/// inside obstacles are included; the figures draw the obstacles over them.
void add_heat_map_rows(UnitRows& rows, const planner::SearchProblem& problem, double resolution_m);

/// Returns tree_PROBLEM_METHOD.txt (polylines "x y depth", the plan as a second block) for each
/// setting "PROBLEM,METHOD" with a table of motions, and heat_map.txt.
std::map<std::string, std::string> tree_files(const SweepPlan& plan, const Tables& tables);

}  // namespace vantage::experiments
