#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "models/world/grid.hpp"
#include "planner/search/arvi.hpp"
#include "planner/search/catalogue.hpp"
#include "planner/tour/tour_planner.hpp"
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Maximum number of bodies other than robots that one plan avoids. The nearest bodies are avoided.
inline constexpr std::size_t kBodiesMax = 8;

/// Returns the maximum number of mixture components used in planning beyond one per target; targets
/// of lower id come first. It is 0 if every belief is a Gaussian, otherwise 7 per target and at
/// most 256, since the search's memory is allocated once.
std::size_t components_max(const scenario::Scenario& scenario);

/// Shared resources of the planners of one thread, so that a team in one process needs only one
/// copy: the scenario, its world's distance field, and the searches with their memory.
///
/// Planners take turns: a search result must be used before the next search begins. A search keeps
/// no state between plans, so its result does not depend on earlier users.
class Workspace {
 public:
  explicit Workspace(const scenario::Scenario& scenario);

  [[nodiscard]] const scenario::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const models::DistanceField& field() const { return field_; }
  /// Returns the index of the robot with that name; nullopt if there is none.
  [[nodiscard]] std::optional<std::size_t> index_of(const std::string& robot) const;
  /// Returns the scenario's search, for all planners that do not need their own
  /// (Algorithm::is_stateful). Created at the first call, like reduced().
  Search& search();
  /// Creates a search for the exclusive use of one robot.
  [[nodiscard]] std::unique_ptr<Search> make_search(int robot_index) const;
  /// Returns the search that generates the candidates of a team decision.
  ReducedValueIteration& reduced();
  /// Returns the planner of tours beyond the horizon. Created at the first call.
  TourPlanner& tours();
  /// Returns the `part` of the ground with the last-seen stamps, one per cell; valid until the next
  /// call. Recomputes the free cells only if another part is requested.
  const models::VisibilityGrid& ground(const models::GridGeometry& part,
                                       const std::vector<std::int64_t>& last_seen_utime);

  /// Commits the first MiB of each array of the searches created so far. Use in real time.
  void prefault();

 private:
  scenario::Scenario scenario_;
  std::unordered_map<std::string, std::size_t> indices_;  ///< index of each robot, by name
  models::DistanceField field_;
  models::VisibilityGrid ground_;  ///< the part of the ground requested last
  std::optional<ReducedValueIteration> reduced_;
  std::optional<TourPlanner> tours_;
  std::unique_ptr<Search> search_;
};

}  // namespace vantage::planner
