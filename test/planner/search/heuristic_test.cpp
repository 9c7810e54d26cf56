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

constexpr std::int64_t kNodes = 100'000;  // number of nodes per sensor

OwnedProblem problem_with(models::SensorKind kind, std::uint64_t seed) {
  OwnedProblem owned = test::random_problem(seed);
  owned.problem.sensors.resize(1);
  models::SensorModel& sensor = owned.problem.sensors[0];
  sensor.kind = kind;
  // Without a minimum range the information would be unlimited.
  if (kind.law().measures_bearing || kind.law().velocity_jacobian != nullptr ||
      kind == test::signal_strength()) {
    sensor.range_min_m = std::max(sensor.range_min_m, 0.3);
  }
  return owned;
}

using test::slack;

// Returns the least cost of a path through each node, from the root to the horizon.
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

TEST_P(Heuristic, IsAdmissibleAndConsistent) {
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
  EXPECT_GT(informed,
            nodes / 6);  // three quarters of the nodes are leaves, whose bound is the floor
}

// A slow robot begins within the minimum range of its target and leaves it in the last steps. The
// bound must count the measurements of these steps.
TEST(StepsAhead, IncludeMeasurementsFromTheMinimumRange) {
  InformationHeuristic heuristic(8, 8);
  for (const models::SensorKind kind : {models::SensorKind::kPosition, models::SensorKind::kRange,
                                        models::SensorKind::kRangeBearing}) {
    int seen = 0;
    for (double away_m = 0.18; away_m < 0.52; away_m += 0.004) {
      OwnedProblem owned;
      SearchProblem& problem = owned.problem;
      problem.horizon_steps = 3;
      problem.start = {away_m, 0.0, 0.0};
      problem.controls = {{0.2, 0.0}, {0.2, 1.0}, {0.2, -1.0}};  // 0.1 m per step
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

// A target above or below the robot is visible within the horizontal distance that corresponds to
// the maximum range. It is never visible if the height difference exceeds the range.
TEST(InformationHeuristic, IsSymmetricInHeight) {
  constexpr double kRange_m = 3.0;
  InformationHeuristic heuristic(4, 8);
  BeliefTable beliefs(4, 8);
  for (const double apart_m : {0.0, 0.5, 2.5, kRange_m, 5.0}) {
    double below = 0.0;
    for (const double side : {-1.0, 1.0}) {
      SearchProblem problem;
      problem.height_m = 8.0;
      problem.horizon_steps = 3;
      problem.controls = {{1.0, 0.0}, {1.0, 1.0}};
      models::SensorModel sensor;
      sensor.kind = models::SensorKind::kPosition;
      sensor.range_max_m = kRange_m;
      problem.sensors = {sensor, sensor};
      problem.sensors[1].range_max_m = 0.5 * kRange_m;
      problem.targets = {
          {{models::TargetKind::kRandomWalk, 3, 0.1},
           {Eigen::Vector3d(1.0, 0.5, 8.0 + side * apart_m), Eigen::Matrix3d::Identity()}}};
      beliefs.reset(problem);
      heuristic.reset(problem, beliefs);
      const double is_m = heuristic.sight_m(0);
      if (apart_m < kRange_m) {
        EXPECT_NEAR(is_m, std::sqrt(kRange_m * kRange_m - apart_m * apart_m), 1e-12);
      } else {
        EXPECT_EQ(is_m, -std::numeric_limits<double>::infinity()) << side * apart_m;
      }
      const double bound = heuristic.cost_to_go(problem.start, 0, {});
      double unseen = 0.0;
      for (int k = 1; k <= 3; ++k) {
        unseen += beliefs.open_loop_cost(k);
      }
      EXPECT_EQ(bound < unseen - 1e-6, apart_m < kRange_m) << side * apart_m;
      if (side < 0.0) {
        below = bound;
      } else {
        EXPECT_NEAR(bound, below, slack(below)) << apart_m;
      }
    }
  }
}

// Information of teammates about a target counts at any step, also the first and the last.
// Information about another target does not.
TEST(InformationHeuristic, CountsFixedInformationAtAnyStep) {
  constexpr int kSteps = 3;
  InformationHeuristic heuristic(4, 8);
  BeliefTable beliefs(4, 8);
  for (int informed_target = 0; informed_target < 3; ++informed_target) {
    for (int step = 0; step < kSteps; ++step) {
      for (const double much : {5.0, 0.0}) {
        SearchProblem problem;
        problem.horizon_steps = kSteps;
        problem.controls = {{1.0, 0.0}};
        for (int m = 0; m < 3; ++m) {
          problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                                     {Eigen::Vector2d(2.0 + m, 0.0), Eigen::Matrix2d::Identity()}});
          problem.fixed_information.emplace_back(index(kSteps));
        }
        models::PositionMatrix M = models::PositionMatrix::Zero(2, 2);
        M(step % 2, step % 2) = much;
        problem.fixed_information[index(informed_target)][index(step)] = M;
        beliefs.reset(problem);
        heuristic.reset(problem, beliefs);
        for (int m = 0; m < 3; ++m) {
          EXPECT_EQ(heuristic.has_fixed(m), m == informed_target && much > 0.0)
              << informed_target << " at " << step;
          EXPECT_EQ(heuristic.has_only_own_information(m), m != informed_target || much == 0.0)
              << informed_target << " at " << step;
        }
      }
    }
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
