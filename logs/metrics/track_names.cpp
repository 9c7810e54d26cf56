#include "logs/metrics/track_names.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "core/assignment.hpp"
#include "core/index.hpp"
#include "logs/metrics/team_estimate.hpp"

namespace vantage::logs {

std::vector<models::TargetBelief> assign_ids_by_position(
    std::span<const models::TargetBelief> tracks, const TruthHistory& truth, int targets,
    Time time) {
  std::vector<const models::TargetBelief*> usable;
  std::vector<Eigen::Vector2d> estimated_m;
  for (const models::TargetBelief& track : tracks) {
    if (const auto estimate = position_estimate(track, "", time, 2)) {
      usable.push_back(&track);
      estimated_m.emplace_back(estimate->mean_m.head<2>());
    }
  }
  std::vector<int> ids;
  std::vector<Eigen::Vector2d> true_m;
  for (int id = 0; id < targets; ++id) {
    if (const auto at_m = truth.target_position_m(id, time)) {
      ids.push_back(id);
      true_m.emplace_back(at_m->head<2>());
    }
  }
  const bool is_by_truth = ids.size() <= usable.size();
  const auto& rows_m = is_by_truth ? true_m : estimated_m;
  const auto& columns_m = is_by_truth ? estimated_m : true_m;
  std::vector<double> cost_m2;
  for (const Eigen::Vector2d& row_m : rows_m) {
    for (const Eigen::Vector2d& column_m : columns_m) {
      cost_m2.push_back((row_m - column_m).squaredNorm());
    }
  }
  AssignmentSolver solver;
  const auto best =
      solver.solve(cost_m2, static_cast<int>(rows_m.size()), static_cast<int>(columns_m.size()));
  std::vector<models::TargetBelief> named;
  for (std::size_t row = 0; row < best.size(); ++row) {
    const std::size_t column = index(best[row]);
    models::TargetBelief target = *usable[is_by_truth ? column : row];
    target.target_id = ids[is_by_truth ? row : column];
    named.push_back(target);
  }
  std::sort(named.begin(), named.end(),
            [](const auto& a, const auto& b) { return a.target_id < b.target_id; });
  return named;
}

}  // namespace vantage::logs
