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

/// Returns {0, 1, 2} m/s × {0, ±1, ±2} rad/s: the fifteen primitives of resilient mapping.
/// Source: dissertation, section 4.F.2.
std::vector<models::UnicycleControl> mapping_primitives();

/// A robot's path over one planning horizon.
struct MapRoute {
  Pose2 start;
  std::vector<int> controls;  ///< indices into the primitives, one per step; empty: stay
  std::vector<Pose2> poses;   ///< poses at the end of each step, where scans are taken
  double gain_nats = 0.0;     ///< information gained in addition to that of the fixed scans
  std::int64_t nodes = 0;     ///< nodes of the search tree
  double value_nats = 0.0;    ///< gain_nats minus the frontier penalty
  /// number of examined steps, including steps that are not allowed; unit of node budgets
  std::int64_t work_nodes = 0;
  bool is_cut = false;  ///< true: the deadline expired, so better routes may exist
};

struct MappingSearchOptions {
  std::vector<models::UnicycleControl> controls = mapping_primitives();
  int horizon_steps = 4;
  double step_s = 1.0;
  /// Minimum distance between robots at any time; each step is assumed to be straight; 0: no
  /// separation.
  double separation_m = 0.0;
  /// Penalty per metre of distance from the route's end to the frontier. Without the penalty, a
  /// robot that gains nothing within its horizon would never move. Not part of gain_nats.
  double frontier_nats_per_m = 0.5;

  /// Predicate of a pose, a control (−1: none) and the number of steps from the start.
  using MotionRule = std::function<bool(const Pose2& at, int control, int steps)>;
  /// True if the control may be driven from the pose. Empty: DriveMap and separation_m decide.
  MotionRule may_drive;
  /// True if a route may end at the pose after the control that led there. Empty: always. If set, a
  /// robot without a full-length route takes the longest route with an allowed end, and stays at
  /// its end.
  MotionRule may_end;
};

/// Planner on one map belief: forward value iteration for one robot, coordinate descent for a team.
/// All results are pure functions of the belief, the starts and the given routes.
/// Source: dissertation, section 4.F.2 (forward search over T_PLAN = 4) and chapter 3 (coordinate
/// descent).
class MappingSearch {
 public:
  /// Both references must outlive this object. Throws UsageError for options without controls or
  /// steps.
  MappingSearch(ViewTable& views, const DriveMap& drive, const MappingSearchOptions& options);

  /// Returns the best of all |U|^T routes from `start`, given the scans of the routes `fixed`.
  /// Excludes routes that may not be driven or that come too near to a fixed route. Of equally
  /// good routes, returns the first in the order of the controls. If no route is allowed, the robot
  /// stays: the result has no controls. The search is exhaustive except for leaves excluded by a
  /// bound. Cost: O(|U|^T) times the cells of a view.
  ///
  /// The deadline is checked before each examined step; between two checks at most one view is
  /// computed (tens of µs). If the deadline expires, returns the best route so far; the greedy
  /// route is tried first.
  MapRoute plan(const Pose2& start, std::span<const MapRoute* const> fixed,
                const Deadline& deadline = Deadline::never());

  /// Returns the information of all scans of `routes` together, nats; ≥ 0, 0 for none. Under
  /// BeamDependence::kBestOfCell the value depends only on the set of scans, otherwise also on
  /// their order. A null entry means a robot without sensing.
  double value(std::span<const MapRoute* const> routes);

  /// Plans the robots in the given order, each given the routes before it; result by index of
  /// `starts`. The team value is at least half of the optimum if value() is submodular and the
  /// searches are exact.
  std::vector<MapRoute> coordinate_descent(std::span<const Pose2> starts,
                                           std::span<const int> order);

  [[nodiscard]] const MappingSearchOptions& options() const { return options_; }

 private:
  /// True if the deadline has expired; otherwise counts one examined step.
  bool is_over();
  [[nodiscard]] bool may_drive(const Pose2& from, int control, const Pose2& to,
                               std::size_t step) const;
  [[nodiscard]] bool may_end(const Pose2& at, int control, std::size_t steps) const;
  void push(int control, const Pose2& to);
  void pop(std::size_t mark);
  /// Returns the greedy route: the best single step, repeatedly. Empty if no control is allowed at
  /// some step or the deadline expired.
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
  MapRoute path_;  ///< route from the root to the current node
  MapRoute best_;
  MapRoute stop_;  ///< longest route of fewer than T steps at whose end the robot may stop
  double best_value_nats_ = 0.0;
  double farthest_m_ = 0.0;  ///< upper limit of the distance to the frontier
};

}  // namespace vantage::planner
