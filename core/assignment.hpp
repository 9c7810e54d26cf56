#pragma once

#include <span>
#include <vector>

namespace vantage {

/// Linear assignment: each row gets a column of its own such that the sum of costs is least.
/// Storage is reused: solving allocates nothing once a problem as large has been solved.
class AssignmentSolver {
 public:
  AssignmentSolver() = default;
  /// Makes room for problems of so many rows and columns.
  AssignmentSolver(int rows_max, int columns_max);

  /// Column of each row; valid until the next call. Of equally good ones the same on every machine.
  /// @param cost  rows × columns, row-major, finite. A pair that must not be costs more than all
  ///              others together.
  /// Precondition: 0 ≤ rows ≤ columns. Cost: O(rows² · columns).
  /// Source: Jonker, Volgenant, A shortest augmenting path algorithm for dense and sparse linear
  /// assignment problems (1987); Crouse, On implementing 2D rectangular assignment algorithms
  /// (2016).
  std::span<const int> solve(std::span<const double> cost, int rows, int columns);

 private:
  std::vector<int> column_of_row_;
  std::vector<int> row_of_column_;  // −1: free
  std::vector<int> way_;            // the row from which a column was reached
  std::vector<char> is_done_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<double> distance_;
};

}  // namespace vantage
