#include "experiments/mapping/mapping_trial.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "experiments/mapping/mapping_worlds.hpp"
#include "planner/mapping/resilient_mapping.hpp"

namespace vantage::experiments {
namespace {

MappingSetup small_setup() {
  MappingSetup setup;
  setup.world = {{{0.0, 0.0}, {7.0, 7.0}}, 3.0, {{{{2.6, 2.7}, {4.1, 4.3}}, 3.0}}, {}};
  setup.robots = 3;
  setup.attacks = 1;
  setup.steps = 8;
  setup.scanner.beams = 48;
  setup.planned_beams = 16;
  setup.search.horizon_steps = 2;
  return setup;
}

TEST(MappingTrial, LearnsTheTrueMap) {
  MappingSetup setup = small_setup();
  setup.attack = AttackKind::kNone;
  setup.steps = 24;
  const MappingOutcome outcome = run_mapping_trial(setup, 1);
  ASSERT_EQ(outcome.steps.size(), 25U);
  EXPECT_LT(outcome.steps.back().entropy_nats, 0.35 * outcome.steps.front().entropy_nats);
  EXPECT_EQ(outcome.wrong_share, 0.0);
  EXPECT_EQ(outcome.steps.back().entropy_nats, outcome.map.entropy_nats());
}

TEST(MappingTrial, DependsOnItsSeedOnly) {
  const MappingSetup setup = small_setup();
  const MappingOutcome a = run_mapping_trial(setup, 5);
  const MappingOutcome b = run_mapping_trial(setup, 5);
  ASSERT_EQ(a.steps.size(), b.steps.size());
  for (std::size_t t = 0; t < a.steps.size(); ++t) {
    ASSERT_EQ(a.steps[t].entropy_nats, b.steps[t].entropy_nats);
    ASSERT_EQ(a.steps[t].attacked, b.steps[t].attacked);
    ASSERT_EQ(a.steps[t].poses, b.steps[t].poses);
  }
  EXPECT_NE(run_mapping_trial(setup, 6).steps.back().entropy_nats, a.steps.back().entropy_nats);
}

TEST(MappingTrial, NeverCollidesWithTheTrueWorld) {
  MappingSetup setup = small_setup();
  for (const bool resilient : {false, true}) {
    setup.planner = resilient ? MappingTeamPlanner(planner::plan_mapping_resiliently)
                              : plan_by_coordinate_descent;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      for (const MappingStep& step : run_mapping_trial(setup, seed).steps) {
        for (const Pose2& pose : step.poses) {
          ASSERT_GE(models::clearance_m(setup.world, pose.position_m()),
                    setup.drive.radius_m - 1e-6);
        }
      }
    }
  }
}

TEST(MappingTrial, LearnsNothingWhileEveryRobotIsAttacked) {
  MappingSetup setup = small_setup();
  setup.attacks = 3;
  const MappingOutcome outcome = run_mapping_trial(setup, 2);
  EXPECT_EQ(outcome.steps.back().attacked, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(outcome.steps.back().entropy_nats, outcome.steps.front().entropy_nats);
}

TEST(AttackedRobots, DependOnTheKindOfAttack) {
  const MappingSetup setup = small_setup();
  const models::OccupancyBelief map(models::GridGeometry::covering(setup.world.bounds, 0.2), 4.0);
  planner::ViewTable views(map, {16, 2.0 * kPi, 0.0, 1.5, 0.01}, {});
  const planner::DriveMap drive(map, {});
  planner::MappingSearchOptions options;
  options.horizon_steps = 1;
  planner::MappingSearch search(views, drive, options);
  const std::vector<Pose2> starts{{2.0, 2.0, 0.0}, {2.2, 2.0, 1.0}, {5.0, 5.0, 0.0}};
  const std::vector<planner::MapRoute> routes = plan_by_coordinate_descent(search, starts, 0);
  const auto left_nats = [&](const std::vector<int>& attacked) {
    std::vector<const planner::MapRoute*> left{&routes[0], &routes[1], &routes[2]};
    for (const int robot : attacked) {
      left[static_cast<std::size_t>(robot)] = nullptr;
    }
    return search.value(left);
  };
  std::mt19937_64 random(7);
  const double worst_nats =
      left_nats(attacked_robots(AttackKind::kWorstCase, 1, routes, search, random));
  for (int i = 0; i < 20; ++i) {
    const std::vector<int> attacked =
        attacked_robots(AttackKind::kRandom, 1, routes, search, random);
    ASSERT_EQ(attacked.size(), 1U);
    ASSERT_LE(worst_nats, left_nats(attacked) + 1e-9);
  }
  EXPECT_TRUE(attacked_robots(AttackKind::kNone, 1, routes, search, random).empty());
  const std::vector<int> best = attacked_robots(AttackKind::kBestAlone, 1, routes, search, random);
  ASSERT_EQ(best.size(), 1U);
  const auto alone_nats = [&](std::size_t robot) {
    const planner::MapRoute* const route = &routes[robot];
    return search.value({&route, 1});
  };
  for (std::size_t robot = 0; robot < routes.size(); ++robot) {
    EXPECT_LE(alone_nats(robot), alone_nats(static_cast<std::size_t>(best[0])));
  }
}

// The attacker chooses the worst case for the previous plans. Before the first plans, no robot is
// attacked.
TEST(MappingTrial, AttackerUsesThePreviousPlans) {
  MappingSetup setup = small_setup();
  setup.attack = AttackKind::kPreviousPlans;
  std::vector<std::vector<int>> worst;
  setup.planner = [&](planner::MappingSearch& search, std::span<const Pose2> starts, int attacks) {
    auto routes = plan_by_coordinate_descent(search, starts, attacks);
    std::mt19937_64 unused;
    worst.push_back(attacked_robots(AttackKind::kWorstCase, attacks, routes, search, unused));
    return routes;
  };
  const MappingOutcome outcome = run_mapping_trial(setup, 3);
  ASSERT_EQ(outcome.steps.size(), 9U);
  ASSERT_EQ(worst.size(), 4U);
  bool differs = false;
  for (std::size_t t = 1; t < outcome.steps.size(); ++t) {
    const std::size_t round = (t - 1) / 2;
    EXPECT_EQ(outcome.steps[t].attacked, round == 0 ? std::vector<int>{} : worst[round - 1]);
    differs = differs || outcome.steps[t].attacked != worst[round];
  }
  EXPECT_TRUE(differs);
}

TEST(MappingWorlds, AreConnectedForARobot) {
  for (const models::World& world : {square_obstacles_world(), corridor_world()}) {
    EXPECT_EQ(world.bounds.max_m, Eigen::Vector2d(16.0, 16.0));
    EXPECT_GT(models::clearance_m(world, {0.8, 0.8}), 0.5);
    EXPECT_GT(models::clearance_m(world, {8.0, 8.0}), 0.5);
    EXPECT_GT(models::clearance_m(world, {15.2, 15.2}), 0.5);
  }
  EXPECT_GT(models::clearance_m(corridor_world(24.0), {13.6, 6.43}), 0.8) << "door of one room";
  EXPECT_GT(models::clearance_m(corridor_world(24.0), {10.4, 17.53}), 0.8)
      << "door of the other room";
}

}  // namespace
}  // namespace vantage::experiments
