#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "models/mapping/beam.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/world/world.hpp"
#include "planner/mapping/mapping_search.hpp"
#include "tools/experiment/mapping_attack.hpp"

namespace vantage::experiment {

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

}  // namespace vantage::experiment
