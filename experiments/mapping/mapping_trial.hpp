#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "estimator/occupancy/occupancy.hpp"
#include "experiments/mapping/mapping_attack.hpp"
#include "models/mapping/beam.hpp"
#include "models/mapping/occupancy_belief.hpp"
#include "models/world/world.hpp"
#include "planner/mapping/mapping_search.hpp"

namespace vantage::experiments {

/// Returns one route for each of `starts`, planned for attacks on up to `attacks` robots.
using MappingTeamPlanner = std::function<std::vector<planner::MapRoute>(
    planner::MappingSearch& search, std::span<const Pose2> starts, int attacks)>;

/// Plans by coordinate descent in the robots' order; ignores attacks.
std::vector<planner::MapRoute> plan_by_coordinate_descent(planner::MappingSearch& search,
                                                          std::span<const Pose2> starts,
                                                          int attacks);

/// Parameters of a trial of resilient mapping. Values that the dissertation does not state are our
/// choice.
/// Source: dissertation, section 4.F.2.
struct MappingSetup {
  models::World world;
  double resolution_m = 0.2;
  int robots = 6;
  int steps = 50;
  int attacks = 2;
  AttackKind attack = AttackKind::kWorstCase;
  MappingTeamPlanner planner = plan_by_coordinate_descent;
  models::BeamSensor scanner{96, 2.0 * kPi, 0.0, 1.5, 0.01};  ///< scanner used for mapping
  int planned_beams = 48;  ///< number of the scanner's beams used for planning
  models::InverseBeamModel inverse = {};
  double clamp_log_odds = 4.595;  ///< log(0.99 / 0.01)
  planner::ViewOptions views = {};
  planner::DriveOptions drive = {};
  planner::MappingSearchOptions search = {};  ///< its horizon is also the replanning period
};

/// Simulated world and shared map of a mapping team: the truth, the robots, and one map from all
/// scans of robots that are not attacked. `setup` must outlive this object; its planner and attack
/// are not used.
class MappedWorld {
 public:
  /// Places the robots together at a random position.
  /// @throws UsageError when the world is too narrow for all robots.
  MappedWorld(const MappingSetup& setup, std::uint64_t seed);

  /// Moves `robot` along the control. If it would touch an obstacle of the true world, it stops up
  /// to two sixteenths of a step before contact, and the function returns false.
  bool drive(std::size_t robot, const models::UnicycleControl& control);
  /// Scans with every robot. The map uses only the scans of robots that are not in `attacked`,
  /// which must be sorted.
  void observe(std::span<const int> attacked);

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
  double entropy_nats = 0.0;  ///< entropy of the team's map, nats
  std::vector<Pose2> poses;   ///< poses, by robot
  std::vector<int> attacked;  ///< robots attacked in this step
};

struct MappingOutcome {
  std::vector<MappingStep> steps;  ///< first entry: after the scan at the start
  std::int64_t stopped = 0;        ///< steps cut short to avoid contact
  std::int64_t nodes = 0;          ///< search nodes of all searches
  std::int64_t beam_cells = 0;     ///< beam cells of all views used for planning
  /// Share of wrong cells among cells with an occupancy < 0.1 or > 0.9, judged at the cell's
  /// centre.
  double wrong_share = 0.0;
  models::OccupancyBelief map;  ///< map at the end of the trial
  models::OccupancyBelief halfway;
};

/// Runs a mapping trial in `setup.world`: plan, let the attacker choose, then drive and scan step
/// by step; repeat. The scans of robots that are not attacked are fused into one map. Robots start
/// together at a random position. Routes are planned on the map. A step that would touch an
/// obstacle of the true world ends just before contact (a bumper), and the robot waits for its next
/// plan. A pure function of its arguments.
MappingOutcome run_mapping_trial(const MappingSetup& setup, std::uint64_t seed);

}  // namespace vantage::experiments
