#pragma once

#include <span>
#include <vector>

namespace vantage {

/// Solver of linear assignment problems: assigns a different column to each row so that the sum of
/// costs is minimal. Storage is reused: solve() allocates only for a problem that is larger than
/// all previous ones.
class AssignmentSolver {
 public:
  AssignmentSolver() = default;
  /// Reserves memory for problems with up to this number of rows and columns.
  AssignmentSolver(int rows_max, int columns_max);

  /// Returns the column of each row; valid until the next call. Ties are resolved in the same way
  /// on every machine.
  /// @param cost  rows × columns, row-major, finite. A forbidden pair needs a cost above the sum of
  ///         all other costs.
  /// Precondition: 0 ≤ rows ≤ columns. Cost: O(rows² · columns).
  /// Source: Jonker, Volgenant, A shortest augmenting path algorithm for dense and sparse linear
  /// assignment problems (1987); Crouse, On implementing 2D rectangular assignment algorithms
  /// (2016).
  std::span<const int> solve(std::span<const double> cost, int rows, int columns);

 private:
  std::vector<int> column_of_row_;
  std::vector<int> row_of_column_;    // −1: not assigned to a row
  std::vector<int> predecessor_row_;  // by column: row from which the column was reached
  std::vector<char> is_done_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<double> distance_;
};

}  // namespace vantage
