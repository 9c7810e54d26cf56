#include "planner/mapping/map_planner.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "core/infinity.hpp"

namespace vantage::planner {
namespace {

int controls_max(const scenario::Scenario& scenario) {
  std::size_t most = 1;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    most = std::max(most, robot.primitives.size());
  }
  return static_cast<int>(most);
}

// Returns the scans that do not depend on the plan: at the start, and along the plans of teammates
// with sensing.
std::vector<MapRoute> routes_taken(const SearchProblem& problem,
                                   const std::vector<FixedTeammate>& teammates) {
  std::vector<MapRoute> routes(1);
  routes.front().poses = {problem.start};
  for (const FixedTeammate& teammate : teammates) {
    if (teammate.jammed) {
      continue;
    }
    MapRoute& route = routes.emplace_back();
    for (int t = 0; t <= problem.horizon_steps; ++t) {
      const Time when = problem.start_time + from_seconds(t * problem.step_s);
      route.poses.push_back(models::at(teammate.trajectory, when).world_from_body);
    }
  }
  return routes;
}

}  // namespace

MapPlanner::MapPlanner(const scenario::Scenario& scenario)
    : spec_(scenario.mapping),
      geometry_(models::map_geometry(scenario.world, spec_)),
      planned_(spec_.scanner),
      motion_(controls_max(scenario), scenario.planner.horizon_steps,
              2 * static_cast<int>(scenario.robots.size())) {
  planned_.beams = spec_.planned_beams;
  models::require_valid(planned_);
}

MapPlan MapPlanner::plan(const SearchProblem& problem, const models::CellCounts& looks,
                         const std::vector<FixedTeammate>& teammates, const Deadline& deadline) {
  const auto cells = static_cast<std::size_t>(geometry_.size());
  require(looks.empty() || looks.size() == cells,
          "map planner: must have one observation count per cell");
  const models::OccupancyBelief belief =
      models::belief_of(geometry_, looks.empty() ? models::CellCounts(cells, 0) : looks, spec_);
  ViewTable views(belief, planned_, {});
  DriveOptions drive_options;
  // The drive map is used only for distances to the frontier; the problem defines the allowed
  // motion.
  drive_options.radius_m = std::max(problem.clearance_m, 0.5 * spec_.resolution_m);
  const DriveMap drive(belief, drive_options);
  motion_.reset(problem);

  MappingSearchOptions options;
  options.controls = problem.controls;
  options.horizon_steps = problem.horizon_steps;
  options.step_s = problem.step_s;
  options.frontier_nats_per_m = spec_.frontier_nats_per_m;
  options.may_drive = [&](const Pose2& from, int control, int steps) {
    return motion_.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), control, steps);
  };
  options.may_end = [&](const Pose2& at, int control, int steps) {
    return control < 0 ? motion_.can_stop_from_start() : motion_.can_stop(at, control, steps);
  };
  MappingSearch search(views, drive, options);
  const std::vector<MapRoute> taken = routes_taken(problem, teammates);
  std::vector<const MapRoute*> fixed;
  for (const MapRoute& route : taken) {
    fixed.push_back(&route);
  }
  const MapRoute route = search.plan(problem.start, fixed, deadline);

  MapPlan plan;
  SearchResult& result = plan.result;
  result.found = !route.controls.empty() || motion_.can_stop_from_start();
  result.controls = route.controls;
  result.poses = route.poses;
  result.moving_steps = static_cast<int>(route.controls.size());
  result.cost = -route.value_nats;
  const bool is_best = !route.is_cut && result.moving_steps == problem.horizon_steps;
  result.lower_bound = is_best ? result.cost : -kInfinity;
  result.epsilon = is_best ? 0.0 : kInfinity;
  result.delta_m = is_best ? 0.0 : kInfinity;
  result.passes = is_best ? 1 : 0;
  result.nodes_generated = route.nodes;
  result.work_nodes = route.work_nodes;
  result.stop_reason = route.is_cut ? StopReason::kDeadline : StopReason::kFinished;
  plan.gain_nats = result.found ? std::max(0.0, route.gain_nats) : 0.0;
  return plan;
}

}  // namespace vantage::planner
