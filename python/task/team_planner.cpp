#include "python/task/team_planner.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "planner/problem/fixed_information.hpp"

namespace vantage::python {
namespace {

std::vector<std::int64_t> widened(const std::vector<int>& controls) {
  return {controls.begin(), controls.end()};
}

class TrackingPlanner final : public TeamPlanner {
 public:
  explicit TrackingPlanner(const TeamPlannerSpec& spec)
      : horizon_steps_(spec.horizon_steps), solver_(request(spec)) {}

  std::vector<std::vector<std::int64_t>> plan(const TeamTask& any) override {
    const auto& task = dynamic_cast<const TrackingTask&>(any);
    models::SensorModel sensor = task.spec().sensor;
    sensor.range_min_m = std::max(
        sensor.range_min_m, std::min(experiments::kPlannedRangeMin_m, 0.5 * sensor.range_max_m));
    problem_.controls = task.spec().controls;
    problem_.horizon_steps = horizon_steps_;
    problem_.step_s = task.spec().targets.step_s;
    problem_.sensors = {sensor};
    problem_.world = &task.world();
    problem_.field = &task.field();
    problem_.clearance_m = task.spec().radius_m;
    problem_.targets.clear();
    for (const models::Gaussian& belief : task.targets().beliefs()) {
      problem_.targets.push_back({task.targets().model(), belief});
    }
    std::vector<planner::FixedTeammate> before;
    std::vector<std::vector<std::int64_t>> plans;
    for (int robot = 0; robot < task.robots(); ++robot) {
      problem_.start = task.poses()[index(robot)];
      problem_.fixed_information = planner::fixed_information(problem_, before);
      const planner::SearchResult& result = solver_.solve(problem_).result;
      before.push_back({planner::to_trajectory(problem_, result), sensor, false});
      plans.push_back(widened(result.controls));
    }
    return plans;
  }

 private:
  static tools::PlanRequest request(const TeamPlannerSpec& spec) {
    tools::PlanRequest request;
    request.algorithm = spec.algorithm;
    request.nodes = spec.nodes;
    return request;
  }

  int horizon_steps_;
  planner::SearchProblem problem_;
  tools::Solver solver_;
};

class MappingPlanner final : public TeamPlanner {
 public:
  explicit MappingPlanner(const TeamPlannerSpec& spec) : horizon_steps_(spec.horizon_steps) {}

  std::vector<std::vector<std::int64_t>> plan(const TeamTask& any) override {
    const auto& task = dynamic_cast<const MappingTask&>(any);
    const experiments::MappingSetup& setup = task.setup();
    models::BeamSensor planned = setup.scanner;
    planned.beams = setup.planned_beams;
    planner::ViewTable views(task.ground().map(), planned, setup.views);
    const planner::DriveMap drive(task.ground().map(), setup.drive);
    planner::MappingSearchOptions options = setup.search;
    options.horizon_steps = horizon_steps_;
    planner::MappingSearch search(views, drive, options);
    std::vector<int> order(task.ground().poses().size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<std::vector<std::int64_t>> plans;
    for (const planner::MapRoute& route : search.coordinate_descent(task.ground().poses(), order)) {
      plans.push_back(widened(route.controls));
    }
    return plans;
  }

 private:
  int horizon_steps_;
};

}  // namespace

std::unique_ptr<TeamPlanner> make_team_planner(const TeamTask& task, const TeamPlannerSpec& spec) {
  const bool is_mapping = dynamic_cast<const MappingTask*>(&task) != nullptr;
  const int longest = is_mapping ? 8 : 64;  // in mapping, forward search is exhaustive and slow
  require(spec.horizon_steps >= 1 && spec.horizon_steps <= longest,
          fmt::format("horizon_steps: must be ≥ 1 and ≤ {}, got {}", longest, spec.horizon_steps));
  if (is_mapping) {
    require(spec.algorithm == "forward",
            fmt::format("algorithm: must be forward for mapping, got {}", spec.algorithm));
    return std::make_unique<MappingPlanner>(spec);
  }
  return std::make_unique<TrackingPlanner>(spec);
}

}  // namespace vantage::python
