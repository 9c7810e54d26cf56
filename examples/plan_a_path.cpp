// Plans the path with the most information about two targets. Needs component planner (and Eigen).
#include <cstdio>

#include <vantage/planner/search/arvi.hpp>

using namespace vantage;

int main() {
  models::World world;
  world.bounds = {{0.0, 0.0}, {20.0, 20.0}};
  world.obstacles.push_back({{{8.0, 6.0}, {9.0, 14.0}}});

  planner::SearchProblem problem;
  problem.start = {2.0, 10.0, 0.0};
  problem.controls = models::standard_primitives();
  problem.horizon_steps = 8;
  problem.step_s = 0.5;
  problem.sensors.push_back({.kind = models::SensorKind::kRangeBearing, .range_max_m = 6.0});
  problem.world = &world;
  problem.clearance_m = 0.3;
  for (const Eigen::Vector2d& position_m :
       {Eigen::Vector2d{9.5, 4.0}, Eigen::Vector2d{6.0, 16.0}}) {
    const models::TargetModel walk{.kind = models::TargetKind::kRandomWalk, .q = 0.05};
    problem.targets.push_back({walk, {position_m, Eigen::Matrix2d::Identity()}});
  }

  planner::ReducedValueIteration search(planner::SearchCapacity{});
  const planner::SearchResult& plan = search.plan(problem, {}, Deadline::nodes(200'000));
  std::printf("cost %.12f nats\n", plan.cost);
  for (const Pose2& pose : plan.poses) {
    std::printf("%8.3f %8.3f %8.3f\n", pose.x_m, pose.y_m, pose.yaw_rad);
  }
  return plan.found ? 0 : 1;
}
