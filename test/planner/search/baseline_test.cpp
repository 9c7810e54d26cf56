#include "planner/search/baseline.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::planner {
namespace {

TEST(LawnMower, CoversTheWholeFloor) {
  const models::Rectangle bounds{{-4.0, -2.0}, {4.0, 2.0}};
  const double range_m = 1.0;
  std::vector<std::vector<Eigen::Vector2d>> paths;
  for (int i = 0; i < 3; ++i) {
    paths.push_back(lawn_mower_waypoints(bounds, i, 3, 1.6 * range_m, 0.5));
  }
  for (double x = -3.5; x <= 3.5; x += 0.25) {
    for (double y = -1.5; y <= 1.5; y += 0.25) {
      double nearest_m = 1e9;
      for (const auto& path : paths) {
        for (std::size_t k = 0; k + 1 < path.size(); ++k) {
          const Eigen::Vector2d d = path[k + 1] - path[k];
          const double s = std::clamp(
              d.squaredNorm() > 0.0 ? (Eigen::Vector2d(x, y) - path[k]).dot(d) / d.squaredNorm()
                                    : 0.0,
              0.0, 1.0);
          nearest_m = std::min(nearest_m, (path[k] + s * d - Eigen::Vector2d(x, y)).norm());
        }
      }
      EXPECT_LT(nearest_m, range_m) << x << " " << y;
    }
  }
}

// Rows are apart by the range of the first sensor, whatever else it carries.
TEST(LawnMower, SpacesItsRowsByTheFirstSensor) {
  models::World world;
  world.bounds = {{-6.0, -4.0}, {6.0, 4.0}};
  SearchProblem problem;
  problem.world = &world;
  problem.clearance_m = 0.2;
  problem.start = {-5.0, -3.5, 0.0};
  problem.horizon_steps = 8;
  problem.controls = {{1.0, 0.0}, {1.0, 1.0}, {1.0, -1.0}, {0.0, 1.0}, {0.0, -1.0}};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  const auto way_with = [&](const std::vector<double>& ranges_m) {
    problem.sensors.clear();
    for (const double range_m : ranges_m) {
      models::SensorModel sensor;
      sensor.range_max_m = range_m;
      problem.sensors.push_back(sensor);
    }
    LawnMower search(SearchCapacity{});
    std::vector<int> way;
    SearchProblem next = problem;
    for (int round = 0; round < 8; ++round) {  // far enough to have changed rows
      const SearchResult& result = search.plan(next, {}, Deadline::never());
      way.insert(way.end(), result.controls.begin(), result.controls.end());
      if (!result.poses.empty()) {
        next.start = result.poses.back();
      }
    }
    return way;
  };
  EXPECT_EQ(way_with({1.0, 4.0}), way_with({1.0}));
  EXPECT_EQ(way_with({4.0, 1.0}), way_with({4.0}));
  EXPECT_NE(way_with({4.0}), way_with({1.0}));
}

}  // namespace
}  // namespace vantage::planner
