#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/deadline.hpp"
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
  double worth_nats = 0.0;    ///< gain_nats less what the way to the frontier costs
  std::int64_t tried = 0;     ///< steps looked at, allowed or not: the unit of node budgets
  bool is_cut = false;        ///< the deadline came first: there may be better ones
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

  /// Asks of a place, the control by which the robot leaves or reached it (−1: none) and the steps
  /// taken until there.
  using MotionRule = std::function<bool(const Pose2& at, int control, int steps)>;
  /// Whether the control may be driven from there. Empty: what DriveMap and separation_m say.
  MotionRule may_drive;
  /// Whether a route may end there. Empty: anywhere. Where there is a rule, a robot that has no
  /// route of all steps takes the longest that may end and stands still behind it.
  MotionRule may_end;
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
  ///
  /// The deadline is asked before each step that is looked at, between two of which at most one
  /// view is worked out (tens of µs, the first time only). When it comes first, the best found by
  /// then: the routes tried so far or, if that is better, the greedy route, which is tried first.
  MapRoute plan(const Pose2& start, std::span<const MapRoute* const> fixed,
                const Deadline& deadline = Deadline::never());

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
  /// True when the deadline has come; otherwise one more step is counted as looked at.
  bool is_over();
  [[nodiscard]] bool may_drive(const Pose2& from, int control, const Pose2& to,
                               std::size_t step) const;
  [[nodiscard]] bool may_end(const Pose2& at, int control, std::size_t steps) const;
  void push(int control, const Pose2& to);
  void pop(std::size_t mark);
  /// Step by step what is worth most then; empty when that ends where no route may end.
  MapRoute greedy_route(const Pose2& start);
  void expand(const Pose2& at, double so_far_nats);
  void offer_stop(int control, double gain_nats);
  [[nodiscard]] bool is_apart(const Pose2& from, const Pose2& to, std::size_t step) const;
  [[nodiscard]] double end_cost_nats(const Pose2& at) const;
  double cover(const MapRoute& route);

  ViewTable* views_;
  const DriveMap* drive_;
  MappingSearchOptions options_;
  MapCoverage coverage_;
  std::span<const MapRoute* const> fixed_;
  const Deadline* deadline_ = nullptr;
  MapRoute path_;  ///< from the root to where the search is
  MapRoute best_;
  MapRoute stop_;  ///< the longest route that is shorter than the horizon and may end
  double best_worth_nats_ = 0.0;
  double farthest_m_ = 0.0;  ///< stands for "no way to any frontier"
};

}  // namespace vantage::planner
