#include "core/assignment.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"

namespace vantage {

AssignmentSolver::AssignmentSolver(int rows_max, int columns_max) {
  const std::size_t rows = index(rows_max);
  const std::size_t columns = index(columns_max);
  column_of_row_.reserve(rows);
  row_price_.reserve(rows);
  row_of_column_.reserve(columns);
  predecessor_row_.reserve(columns);
  is_done_.reserve(columns);
  column_price_.reserve(columns);
  distance_.reserve(columns);
}

// Finds the shortest path to an unassigned column for each row.
// Long function: it contains one loop.
std::span<const int> AssignmentSolver::solve(std::span<const double> cost, int rows, int columns) {
  demand(rows >= 0 && rows <= columns && cost.size() == index(rows) * index(columns),
         "an assignment needs at least as many columns as rows, and one cost per row and column");
  column_of_row_.assign(index(rows), -1);
  row_price_.assign(index(rows), 0.0);
  row_of_column_.assign(index(columns), -1);
  column_price_.assign(index(columns), 0.0);
  predecessor_row_.assign(index(columns), -1);
  is_done_.assign(index(columns), 0);
  distance_.assign(index(columns), kInfinity);
  for (int first = 0; first < rows; ++first) {
    std::fill(is_done_.begin(), is_done_.end(), static_cast<char>(0));
    std::fill(distance_.begin(), distance_.end(), kInfinity);
    double reached = 0.0;
    int row = first;
    int free_column = -1;
    while (free_column < 0) {
      int nearest = -1;
      for (int j = 0; j < columns; ++j) {
        if (is_done_[index(j)] != 0) {
          continue;
        }
        const double through = reached + cost[index(row) * index(columns) + index(j)] -
                               row_price_[index(row)] - column_price_[index(j)];
        if (through < distance_[index(j)]) {
          distance_[index(j)] = through;
          predecessor_row_[index(j)] = row;
        }
        if (nearest < 0 || distance_[index(j)] < distance_[index(nearest)]) {
          nearest = j;
        }
      }
      reached = distance_[index(nearest)];
      is_done_[index(nearest)] = 1;
      row = row_of_column_[index(nearest)];
      free_column = row < 0 ? nearest : -1;
    }
    // Keep every reduced cost ≥ 0, and the reduced costs of assigned pairs at 0.
    row_price_[index(first)] += reached;
    for (int j = 0; j < columns; ++j) {
      if (is_done_[index(j)] != 0 && j != free_column) {
        const double less = reached - distance_[index(j)];
        row_price_[index(row_of_column_[index(j)])] += less;
        column_price_[index(j)] -= less;
      }
    }
    for (int column = free_column; column >= 0;) {
      const int from = predecessor_row_[index(column)];
      row_of_column_[index(column)] = from;
      std::swap(column_of_row_[index(from)], column);
      if (from == first) {
        break;
      }
    }
  }
  return column_of_row_;
}

}  // namespace vantage
