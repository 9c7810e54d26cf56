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
#include "scenario/scenario.hpp"

namespace vantage::planner {

/// Number of bodies other than robots, the nearest, that one plan keeps from.
inline constexpr std::size_t kBodiesMax = 8;

/// How many places where targets may be are planned with beyond one for each, who has a lower id
/// first: none where every belief is a Gaussian, else seven more of each target and 256 in all, for
/// the search's memory is taken once.
std::size_t parts_max(const scenario::Scenario& scenario);

/// What the planners of one thread have in common, so that a team in one process costs one of it:
/// the scenario, its world's distance field, and the searches with their memory.
///
/// Planners take turns: what a search found has to be taken before the next one begins. A search
/// keeps nothing from one plan to the next, so it finds the same whoever used it before.
class Workspace {
 public:
  explicit Workspace(const scenario::Scenario& scenario);

  [[nodiscard]] const scenario::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const models::DistanceField& field() const { return field_; }
  /// Which of the scenario's robots is called so; nullopt: none.
  [[nodiscard]] std::optional<std::size_t> index_of(const std::string& robot) const;
  /// The scenario's search, for all who do not need one of their own (Algorithm::remembers). Built,
  /// as reduced(), when it is first asked for.
  Search& search();
  /// The scenario's search for that robot alone.
  [[nodiscard]] std::unique_ptr<Search> make_search(int robot_index) const;
  /// Makes the candidates of a team's decision.
  ReducedValueIteration& reduced();
  /// That part of the ground as it was last seen, one stamp a cell; good until the next call. Which
  /// cells are free is found anew only when another part is asked for.
  const models::VisibilityGrid& ground(const models::GridGeometry& part,
                                       const std::vector<std::int64_t>& last_seen_utime);

  /// For real time: the search that the scenario's planners use takes all of its memory now.
  void prefault();

 private:
  scenario::Scenario scenario_;
  std::unordered_map<std::string, std::size_t> indices_;  ///< of robots, by name
  models::DistanceField field_;
  models::VisibilityGrid ground_;  ///< the part that was asked for last
  std::optional<ReducedValueIteration> reduced_;
  std::unique_ptr<Search> search_;
};

}  // namespace vantage::planner
