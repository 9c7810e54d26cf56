#include "planner/search/heuristic.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "test/support/own_sensor.hpp"

namespace vantage::planner {
namespace {

using test::FullTree;

constexpr std::int64_t kNodes = 100'000;  // of each sensor

OwnedProblem problem_with(models::SensorKind kind, std::uint64_t seed) {
  OwnedProblem owned = test::random_problem(seed);
  owned.problem.sensors.resize(1);
  models::SensorModel& sensor = owned.problem.sensors[0];
  sensor.kind = kind;
  // Where nearness has no limit, what a look tells has none.
  if (kind.law().measures_bearing || kind == test::signal_strength()) {
    sensor.range_min_m = std::max(sensor.range_min_m, 0.3);
  }
  return owned;
}

using test::slack;

// What a node costs at least, from the root to the end.
std::vector<double> bounds_of(const OwnedProblem& owned, const FullTree& full,
                              InformationHeuristic& heuristic) {
  heuristic.reset(owned.problem, full.expander.beliefs());
  std::vector<double> bounds;
  for (NodeId id = 0; id < full.tree.node_count(); ++id) {
    const Node& node = full.tree[id];
    bounds.push_back(node.cost + heuristic.cost_to_go(node.world_from_body, node.depth,
                                                      full.tree.posterior(id)));
  }
  return bounds;
}

class Heuristic : public ::testing::TestWithParam<models::SensorKind> {};

TEST_P(Heuristic, IsAdmissibleConsistentAndNotBelowItsStageFloors) {
  InformationHeuristic heuristic(8, 8);
  std::int64_t nodes = 0;
  std::int64_t informed = 0;
  for (std::uint64_t seed = 0; nodes < kNodes; ++seed) {
    const OwnedProblem owned = problem_with(GetParam(), seed);
    const FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    const std::vector<double> bounds = bounds_of(owned, full, heuristic);
    const std::vector<double> best = full.best_through(owned.problem.horizon_steps);
    for (NodeId id = 0; id < full.tree.node_count(); ++id) {
      const Node& node = full.tree[id];
      ASSERT_FALSE(std::isnan(bounds[id]));
      ASSERT_LE(bounds[id], best[id] + slack(best[id])) << "seed " << seed << " node " << id;
      if (node.parent != kNoNode) {
        ASSERT_LE(bounds[node.parent], bounds[id] + slack(bounds[id]))
            << "seed " << seed << " node " << id;
        const double stage = node.cost - full.tree[node.parent].cost;
        ASSERT_LE(heuristic.stage_floor(node.depth), stage + slack(stage)) << "seed " << seed;
      }
      double floors = node.cost;
      for (int k = node.depth + 1; k <= owned.problem.horizon_steps; ++k) {
        floors += heuristic.stage_floor(k);
      }
      ASSERT_LE(floors, bounds[id] + slack(floors)) << "seed " << seed << " node " << id;
      informed += bounds[id] > floors + slack(floors) ? 1 : 0;
      ++nodes;
    }
  }
  EXPECT_GT(informed, nodes / 6);  // three in four are leaves, where nothing is ahead
}

// A slow robot nearer to its target than it sees, which gets just far enough in the last steps: no
// bound may take that for nothing.
TEST(StepsAhead, CountOnLooksFromJustBeyondTheLeastRange) {
  InformationHeuristic heuristic(8, 8);
  for (const models::SensorKind kind : {models::SensorKind::kPosition, models::SensorKind::kRange,
                                        models::SensorKind::kRangeBearing}) {
    int seen = 0;
    for (double away_m = 0.18; away_m < 0.52; away_m += 0.004) {
      OwnedProblem owned;
      SearchProblem& problem = owned.problem;
      problem.horizon_steps = 3;
      problem.start = {away_m, 0.0, 0.0};
      problem.controls = {{0.2, 0.0}, {0.2, 1.0}, {0.2, -1.0}};  // a tenth of a metre in a step
      models::SensorModel sensor;
      sensor.kind = kind;
      sensor.range_min_m = 0.5;
      sensor.range_max_m = 3.0;
      problem.sensors = {sensor};
      problem.targets = {{{models::TargetKind::kRandomWalk, 2, 0.01},
                          {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
      const FullTree full(problem);
      const double best = full.best_through(problem.horizon_steps)[0];
      const double bound = bounds_of(owned, full, heuristic)[0];
      EXPECT_LE(bound, best + slack(best)) << kind.name() << " from " << away_m;
      SearchProblem blind = problem;
      blind.sensors.clear();
      seen += best < score(blind, std::vector<Pose2>(3, problem.start)) - 0.1 ? 1 : 0;
    }
    EXPECT_GT(seen, 50) << kind.name();
  }
}

std::string name_of_case(const ::testing::TestParamInfo<models::SensorKind>& each) {
  return std::string(each.param.name());
}

std::vector<models::SensorKind> kinds_and_one_of_ones_own() {
  const auto ours = models::all_sensor_kinds();
  std::vector<models::SensorKind> kinds(ours.begin(), ours.end());
  kinds.push_back(test::signal_strength());
  return kinds;
}

INSTANTIATE_TEST_SUITE_P(Planner, Heuristic, ::testing::ValuesIn(kinds_and_one_of_ones_own()),
                         name_of_case);

}  // namespace
}  // namespace vantage::planner
