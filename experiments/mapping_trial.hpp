#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "estimator/occupancy.hpp"
#include "experiments/mapping_attack.hpp"
#include "models/mapping/beam.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/world/world.hpp"
#include "planner/mapping/mapping_search.hpp"

namespace vantage::experiments {

/// One route for each of `starts`, prepared for the loss of up to `attacks` of them.
using MappingTeamPlanner = std::function<std::vector<planner::MapRoute>(
    planner::MappingSearch& search, std::span<const Pose2> starts, int attacks)>;

/// Coordinate descent in the order of the robots; takes no heed of attacks.
std::vector<planner::MapRoute> plan_by_coordinate_descent(planner::MappingSearch& search,
                                                          std::span<const Pose2> starts,
                                                          int attacks);

/// A trial of resilient mapping. Source: dissertation 4 F.2; what it does not say is ours.
struct MappingSetup {
  models::World world;
  double resolution_m = 0.2;
  int robots = 6;
  int steps = 50;
  int attacks = 2;
  AttackKind attack = AttackKind::kWorstCase;
  MappingTeamPlanner planner = plan_by_coordinate_descent;
  models::BeamSensor scanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};  ///< that maps
  int planned_beams = 48;                                     ///< of them, for planning
  models::InverseBeamModel inverse = {};
  double clamp_log_odds = 4.595;  ///< log(0.99 / 0.01)
  planner::ViewOptions views = {};
  planner::DriveOptions drive = {};
  planner::MappingSearchOptions search = {};  ///< its horizon is also the replanning period
};

/// What a mapping team drives about in and what it has found out: the truth, the robots, one map of
/// all scans that count. `setup` must outlive it; its planner and attacker are not asked.
class MappedWorld {
 public:
  /// Robots start together at a random place.
  /// @throws UsageError when the world has no room for that.
  MappedWorld(const MappingSetup& setup, std::uint64_t seed);

  /// Moves `robot` along the control as far as the true world allows less a sixteenth of the step;
  /// false when that is not all.
  bool drive(std::size_t robot, const models::UnicycleControl& control);
  /// Every robot scans; the map learns of those that are not in `attacked`, which is sorted.
  void look(std::span<const int> attacked);

  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  [[nodiscard]] const models::OccupancyBelief& map() const { return map_; }

 private:
  const MappingSetup& setup_;
  std::mt19937_64 noise_;
  estimator::OccupancyFusion fusion_;
  models::OccupancyBelief map_;
  std::vector<Pose2> poses_;
};

struct MappingStep {
  double entropy_nats = 0.0;  ///< of the team's map
  std::vector<Pose2> poses;   ///< of the robots
  std::vector<int> attacked;  ///< that did not see in this step
};

struct MappingOutcome {
  std::vector<MappingStep> steps;  ///< the first is after the look from the start
  std::int64_t stopped = 0;     ///< steps cut short, since the robot would have touched something
  std::int64_t nodes = 0;       ///< of all searches
  std::int64_t beam_cells = 0;  ///< of all views that were planned with
  /// Share of the cells believed free or occupied (beyond 9 to 1) that are not so at their centre.
  double wrong_share = 0.0;
  models::OccupancyBelief map;  ///< at the end
  models::OccupancyBelief halfway;
};

/// Drives a team about `setup.world`: plan, let the attacker choose, drive and scan step by step,
/// fuse the scans of those that are not attacked into one map, again. Robots start together at a
/// random place. The route is planned on the map; a step that would touch the true world ends just
/// before (a bumper), and the robot then waits for its next plan. A pure function of its arguments.
MappingOutcome run_mapping_trial(const MappingSetup& setup, std::uint64_t seed);

}  // namespace vantage::experiments
