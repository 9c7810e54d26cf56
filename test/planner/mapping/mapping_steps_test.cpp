// Tests of the step counts and the defaults of a mapping search.

#include <algorithm>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/mapping/mapping_search.hpp"

namespace vantage::planner {
namespace {

using models::GridGeometry;
using models::OccupancyBelief;

// Three controls, three steps, all allowed: the greedy route evaluates 3 · 3 steps, the tree 3 + 9
// + 27. All cells are known, so no step gains information and no frontier exists. The frontier
// distance is then the sum of both sides of the ground. Only the first leaf improves the result.
TEST(MappingSearch, CountsEvaluatedSteps) {
  const GridGeometry ground{{0.0, 0.0}, 0.25, 40, 20};
  OccupancyBelief belief(ground, 3.0);
  for (int cell = 0; cell < ground.size(); ++cell) {
    belief.add_log_odds(cell, -9.0);
  }
  ViewTable views(belief, {16, 2.0 * kPi, 0.0, 1.5, 0.01}, {});
  const DriveMap drive(belief, {});
  MappingSearchOptions options;
  options.controls = {{1.0, 0.0}, {0.5, 1.0}, {0.5, -1.0}};
  options.horizon_steps = 3;
  options.step_s = 0.5;
  options.may_drive = [](const Pose2& /*at*/, int /*control*/, int /*steps*/) { return true; };
  MappingSearch search(views, drive, options);
  for (const std::int64_t budget : {0, 8, 9, 47, 48, 1000}) {
    const MapRoute route = search.plan({5.0, 2.5, 0.0}, {}, Deadline::nodes(budget));
    EXPECT_EQ(route.work_nodes, std::min<std::int64_t>(budget, 48));
    EXPECT_EQ(route.is_cut, budget < 48) << budget;
    EXPECT_EQ(route.controls.size(), budget < 9 ? 0U : 3U) << budget;
    EXPECT_EQ(route.gain_nats, 0.0);
    EXPECT_NEAR(route.value_nats, -0.5 * 0.25 * 60, 1e-12) << budget;
    if (budget >= 47) {
      EXPECT_EQ(route.nodes, 3 + 9 + 1);
    }
  }
}

TEST(MappingSearch, HasTheStatedDefaults) {
  const MappingSearchOptions options;
  EXPECT_EQ(options.horizon_steps, 4);
  EXPECT_EQ(options.step_s, 1.0);
  EXPECT_EQ(options.separation_m, 0.0);
  EXPECT_EQ(options.frontier_nats_per_m, 0.5);
  ASSERT_EQ(options.controls.size(), 15U);
  for (const double speed_mps : {0.0, 1.0, 2.0}) {
    for (const double yaw_rate_radps : {0.0, 1.0, -1.0, 2.0, -2.0}) {
      EXPECT_EQ(std::count(options.controls.begin(), options.controls.end(),
                           models::UnicycleControl{speed_mps, yaw_rate_radps}),
                1);
    }
  }
}

TEST(MappingSearch, RefusesEmptyHorizons) {
  const OccupancyBelief belief({{0.0, 0.0}, 0.25, 32, 32}, 3.0);
  ViewTable views(belief, {16, 2.0 * kPi, 0.0, 1.5, 0.01}, {});
  const DriveMap drive(belief, {});
  MappingSearchOptions options;
  options.horizon_steps = 1;
  EXPECT_NO_THROW(MappingSearch(views, drive, options));
  options.horizon_steps = 0;
  EXPECT_THROW(MappingSearch(views, drive, options), UsageError);
  options.horizon_steps = 4;
  options.step_s = 0.0;
  EXPECT_THROW(MappingSearch(views, drive, options), UsageError);
}

}  // namespace
}  // namespace vantage::planner
