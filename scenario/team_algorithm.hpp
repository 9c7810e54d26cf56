#pragma once

#include <span>
#include <string_view>

namespace vantage::scenario {

/// Properties of a team algorithm: a row of the table in team_algorithm.cpp.
struct TeamAlgorithmRow {
  std::string_view name;  ///< value of planner.team_algorithm in scenario files
  /// The robots exchange proposals of the whole team's solution before they plan. This requires
  /// objective: tracking, a search with candidates, no attacks and no neighbourhood.
  bool exchanges_solutions;
};

/// Method by which the robots of a team agree on their plans, stored as a pointer to its table row.
class TeamAlgorithm {
 public:
  constexpr explicit TeamAlgorithm(const TeamAlgorithmRow& row) : row_(&row) {}
  [[nodiscard]] constexpr std::string_view name() const { return row_->name; }
  [[nodiscard]] constexpr bool exchanges_solutions() const { return row_->exchanges_solutions; }

  friend constexpr bool operator==(TeamAlgorithm a, TeamAlgorithm b) { return a.row_ == b.row_; }

  /// Robots plan in turn; each receives the newest plans of the other robots.
  static const TeamAlgorithm kCoordinateDescent;
  /// Robots propose changes of a team solution (docs/decisions/0006).
  static const TeamAlgorithm kLocalSearch;

 private:
  const TeamAlgorithmRow* row_;
};

/// Returns all team algorithms that scenarios may name, in display order.
std::span<const TeamAlgorithm> all_team_algorithms();

}  // namespace vantage::scenario
