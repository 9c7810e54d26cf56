#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "models/motion/unicycle.hpp"
#include "planner/mapping/drive_map.hpp"
#include "planner/mapping/view_table.hpp"

namespace vantage::planner {

/// {0, 1, 2} m/s × {0, ±1, ±2} rad/s: the fifteen primitives of resilient mapping.
/// Source: dissertation 4 F.2.
std::vector<models::UnicycleControl> mapping_primitives();

/// A robot's way over one planning horizon.
struct MapRoute {
  Pose2 start;
  std::vector<int> controls;  ///< indices into the primitives, one a step; none: stand still
  std::vector<Pose2> poses;   ///< where each step ends; a scan is taken there
  double gain_nats = 0.0;     ///< what its scans add to those it was planned against
  std::int64_t nodes = 0;     ///< of the search tree
};

struct MappingSearchOptions {
  std::vector<models::UnicycleControl> controls = mapping_primitives();
  int horizon_steps = 4;
  double step_s = 1.0;
  /// Least distance of robots at any time, taking each step as straight; 0: they may pass through
  /// each other.
  double separation_m = 0.0;
  /// A route that ends farther from the frontier is worth less by this much a metre: without it a
  /// robot that sees nothing new within its horizon stands still for ever. It is not part of
  /// gain_nats.
  double frontier_nats_per_m = 0.5;
};

/// Plans against one belief: one robot by forward value iteration, a team by coordinate descent.
/// Everything it says is a pure function of the belief, the starts and the routes handed in.
/// Source: dissertation 4 F.2 (forward search over T_PLAN = 4), 3 (coordinate descent).
class MappingSearch {
 public:
  /// Both must outlive this. Throws UsageError for options without controls or steps.
  MappingSearch(ViewTable& views, const DriveMap& drive, const MappingSearchOptions& options);

  /// The best of all |U|^T routes from `start` when the scans of `fixed` are taken anyway, those
  /// that may not be driven or that come too near to a fixed route left out. Equals: the first in
  /// the order of the controls. When nothing is allowed the robot stands still: no controls.
  /// Exhaustive but for leaves that a bound shows to be no better. O(|U|^T) times the cells of a
  /// view.
  MapRoute plan(const Pose2& start, std::span<const MapRoute* const> fixed);

  /// The information of all scans of `routes` together, nats. ≥ 0, 0 for none; a function of the
  /// set alone under BeamDependence::kBestOfCell, of the order given otherwise. Null entries count
  /// as robots that do not look.
  double value(std::span<const MapRoute* const> routes);

  /// Robots plan in the order given, each against those before it; result by index of `starts`.
  /// At least half of the best team value where value() is submodular and the searches are exact.
  std::vector<MapRoute> coordinate_descent(std::span<const Pose2> starts,
                                           std::span<const int> order);

  [[nodiscard]] const MappingSearchOptions& options() const { return options_; }

 private:
  void expand(const Pose2& at, double so_far_nats);
  [[nodiscard]] bool is_apart(const Pose2& from, const Pose2& to, std::size_t step) const;
  [[nodiscard]] double end_cost_nats(const Pose2& at) const;
  double cover(const MapRoute& route);

  ViewTable* views_;
  const DriveMap* drive_;
  MappingSearchOptions options_;
  MapCoverage coverage_;
  std::span<const MapRoute* const> fixed_;
  MapRoute path_;  ///< from the root to where the search is
  MapRoute best_;
  double best_worth_nats_ = 0.0;
  double farthest_m_ = 0.0;  ///< stands for "no way to any frontier"
};

}  // namespace vantage::planner
