#pragma once

#include <string>

#include "planner/search/problem.hpp"
#include "planner/search/tree.hpp"

namespace vantage::bench {

/// What an average path in the tree costs a step: the mean of g(n)/t over the nodes of each depth t
/// = 1 … T − 1, and the mean of these, so that a tree with many deep nodes is not the better for
/// it. The leaves do not count: best-first searches keep none.
double cost_per_path(const planner::Tree& tree, int horizon_steps);

/// Writes the motions of the tree's first `nodes_max` nodes as polylines "x y depth" with blank
/// lines between, for gnuplot; the plan, if one was found, as a second block of lines.
void write_tree(const std::string& path, const planner::SearchProblem& problem,
                const planner::Tree& tree, const planner::SearchResult& result,
                std::size_t nodes_max);

/// Writes h(x, y) of the root's beliefs over the world by Thm 6, one row of the grid a line; nan
/// inside obstacles.
void write_heat_map(const std::string& path, const planner::SearchProblem& problem,
                    double resolution_m);

}  // namespace vantage::bench
