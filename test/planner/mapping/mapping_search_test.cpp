#include "planner/mapping/mapping_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/mapping/resilient_mapping.hpp"
#include "test/planner/mapping/random_map.hpp"

namespace vantage::planner {
namespace {

using models::GridGeometry;
using models::OccupancyBelief;

const GridGeometry kGrid{{0.0, 0.0}, 0.25, 32, 32};

// A random map with the tables for a search, and a team with robots close together.
struct Bench {
  Bench(test::Random& random, int horizon_steps, double frontier_nats_per_m,
        BeamDependence dependence = BeamDependence::kBestOfCell)
      : belief(test::random_map(random, kGrid, 0.01)),
        views(belief, {16, 2.0 * kPi, 0.0, 1.5, 0.01}, views_options(dependence)),
        drive(belief, {}) {
    options.controls = {{0.0, 1.0}, {1.0, 0.0}, {1.0, 1.5}, {2.0, -1.0}};
    options.horizon_steps = horizon_steps;
    options.frontier_nats_per_m = frontier_nats_per_m;
    for (int i = 0; i < 4; ++i) {
      starts.push_back(
          {random.uniform(3.0, 5.0), random.uniform(3.0, 5.0), random.uniform(-kPi, kPi)});
    }
  }
  static ViewOptions views_options(BeamDependence dependence) {
    ViewOptions options;
    options.dependence = dependence;
    return options;
  }

  OccupancyBelief belief;
  ViewTable views;
  DriveMap drive;
  MappingSearchOptions options;
  std::vector<Pose2> starts;
};

// Returns all feasible routes in the order of the controls.
std::vector<MapRoute> all_routes(const Bench& bench, const Pose2& start) {
  std::vector<MapRoute> routes{{start, {}, {}, 0.0, 0}};
  for (int t = 0; t < bench.options.horizon_steps; ++t) {
    std::vector<MapRoute> longer;
    for (const MapRoute& route : routes) {
      const Pose2 at = route.poses.empty() ? start : route.poses.back();
      for (std::size_t c = 0; c < bench.options.controls.size(); ++c) {
        if (bench.drive.is_free(at, bench.options.controls[c], bench.options.step_s)) {
          longer.push_back(route);
          longer.back().controls.push_back(static_cast<int>(c));
          longer.back().poses.push_back(
              models::step_unicycle(at, bench.options.controls[c], bench.options.step_s));
        }
      }
    }
    routes = std::move(longer);
  }
  return routes;
}

std::vector<const MapRoute*> pointers(const std::vector<MapRoute>& routes) {
  std::vector<const MapRoute*> result;
  for (const MapRoute& route : routes) {
    result.push_back(&route);
  }
  return result;
}

TEST(MappingSearch, FindsTheBestOfAllRoutes) {
  test::Random random(4701);
  for (int i = 0; i < 40; ++i) {
    const BeamDependence dependence =
        i % 2 == 0 ? BeamDependence::kBestOfCell : BeamDependence::kDropBeams;
    Bench bench(random, 3, 0.5, dependence);
    MappingSearch search(bench.views, bench.drive, bench.options);
    const MapRoute mate = search.plan(bench.starts[0], {});
    const std::vector<const MapRoute*> fixed{&mate};
    const MapRoute plan = search.plan(bench.starts[1], fixed);
    const auto worth = [&](const MapRoute& route) {
      return search.value(std::vector<const MapRoute*>{&mate, &route}) - search.value(fixed) -
             0.5 * std::min(16.0, bench.drive.frontier_distance_m(route.poses.back().position_m()));
    };
    double best_nats = -std::numeric_limits<double>::infinity();
    for (const MapRoute& route : all_routes(bench, bench.starts[1])) {
      best_nats = std::max(best_nats, worth(route));
    }
    ASSERT_NEAR(worth(plan), best_nats, 1e-9) << i;
    ASSERT_NEAR(plan.gain_nats,
                search.value(std::vector<const MapRoute*>{&mate, &plan}) - search.value(fixed),
                1e-9);
  }
}

// With a budget for the greedy route only, the result is that route: the best next step at each
// pose.
TEST(MappingSearch, ReturnsTheGreedyRouteAtAnEarlyDeadline) {
  test::Random random(4711);
  int greedy_routes = 0;
  for (int i = 0; i < 20; ++i) {
    Bench bench(random, 3, 0.5);
    MappingSearch search(bench.views, bench.drive, bench.options);
    const auto value_nats = [&](const MapRoute& route) {
      return search.value(std::vector<const MapRoute*>{&route}) -
             0.5 * std::min(16.0, bench.drive.frontier_distance_m(route.poses.back().position_m()));
    };
    MapRoute greedy{bench.starts[0], {}, {}, 0.0, 0};
    for (int step = 0; step < 3; ++step) {
      const Pose2 at = greedy.poses.empty() ? greedy.start : greedy.poses.back();
      std::optional<MapRoute> best;
      for (std::size_t c = 0; c < bench.options.controls.size(); ++c) {
        if (bench.drive.is_free(at, bench.options.controls[c], bench.options.step_s)) {
          MapRoute longer = greedy;
          longer.controls.push_back(static_cast<int>(c));
          longer.poses.push_back(
              models::step_unicycle(at, bench.options.controls[c], bench.options.step_s));
          if (!best || value_nats(longer) > value_nats(*best)) {
            best = std::move(longer);
          }
        }
      }
      if (!best) {
        break;
      }
      greedy = *best;
    }
    if (greedy.controls.size() < 3) {
      continue;  // the greedy route has no next step
    }
    ++greedy_routes;
    const auto controls = static_cast<std::int64_t>(bench.options.controls.size());
    const MapRoute cut = search.plan(bench.starts[0], {}, Deadline::nodes(3 * controls));
    EXPECT_TRUE(cut.is_cut);
    EXPECT_EQ(cut.controls, greedy.controls) << i;
    const double gain_nats = search.value(std::vector<const MapRoute*>{&greedy});
    EXPECT_NEAR(cut.gain_nats, gain_nats, 1e-9) << i;
    EXPECT_NEAR(cut.value_nats, value_nats(greedy), 1e-9) << i;
  }
  EXPECT_GT(greedy_routes, 10);
}

TEST(MappingSearch, IsDeterministic) {
  test::Random random(4702);
  Bench bench(random, 3, 0.5);
  MappingSearch search(bench.views, bench.drive, bench.options);
  const MapRoute first = search.plan(bench.starts[0], {});
  search.plan(bench.starts[1], std::vector<const MapRoute*>{&first});
  const MapRoute again = search.plan(bench.starts[0], {});
  EXPECT_EQ(first.controls, again.controls);
  EXPECT_EQ(first.gain_nats, again.gain_nats);
}

/// A bench with routes for four robots by coordinate descent.
struct PlannedBench {
  explicit PlannedBench(unsigned seed) : random(seed) {}
  test::Random random;
  Bench bench{random, 2, 0.5};
  MappingSearch search{bench.views, bench.drive, bench.options};
  std::vector<MapRoute> routes =
      search.coordinate_descent(bench.starts, std::vector<int>{0, 1, 2, 3});
};

TEST(MappingSearch, TeamValueIsIndependentOfOrderAndZeroWhenEmpty) {
  PlannedBench all(4703);
  MappingSearch& search = all.search;
  const std::vector<MapRoute>& routes = all.routes;
  std::vector<const MapRoute*> team = pointers(routes);
  const double value_nats = search.value(team);
  double sum_nats = 0.0;
  for (const MapRoute& route : routes) {
    sum_nats += route.gain_nats;
  }
  EXPECT_NEAR(value_nats, sum_nats, 1e-9);
  std::reverse(team.begin(), team.end());
  EXPECT_NEAR(search.value(team), value_nats, 1e-9);
  EXPECT_EQ(search.value({}), 0.0);
  EXPECT_EQ(search.value(std::vector<const MapRoute*>{nullptr, nullptr}), 0.0);
}

TEST(MappingSearch, GainsLessWhereTeammatesScan) {
  test::Random random(4704);
  Bench bench(random, 3, 0.0);
  MappingSearch search(bench.views, bench.drive, bench.options);
  const MapRoute first = search.plan(bench.starts[0], {});
  const MapRoute twin = search.plan(bench.starts[0], std::vector<const MapRoute*>{&first});
  EXPECT_NE(twin.controls, first.controls);
  EXPECT_LT(twin.gain_nats, first.gain_nats);
}

TEST(MappingSearch, KeepsSeparationFromTeammates) {
  test::Random random(4705);
  for (int i = 0; i < 20; ++i) {
    Bench bench(random, 3, 0.5);
    bench.options.separation_m = 0.5;
    MappingSearch search(bench.views, bench.drive, bench.options);
    const std::vector<MapRoute> routes =
        search.coordinate_descent(std::span(bench.starts).first(2), std::vector<int>{0, 1});
    if (routes[1].controls.empty()) {
      continue;  // the robot is enclosed and does not move
    }
    for (std::size_t t = 0; t < 3; ++t) {
      ASSERT_GE((routes[0].poses[t].position_m() - routes[1].poses[t].position_m()).norm(), 0.5);
    }
  }
}

// Both robots drive straight and at constant speed in each step, where their distance is sampled. A
// robot without a route, or after the end of its route, does not block the other robots.
TEST(MappingSearch, FindsTheBestSeparatedRoute) {
  test::Random random(4712);
  int refused = 0;
  int compared = 0;
  for (int i = 0; i < 20; ++i) {
    Bench bench(random, 3, 0.5);
    bench.options.separation_m = 0.5;
    MappingSearch search(bench.views, bench.drive, bench.options);
    const MapRoute mate = search.plan(bench.starts[0], {});
    const MapRoute brief{bench.starts[2], {0}, {bench.starts[2]}, 0.0, 0};
    const std::vector<const MapRoute*> fixed{&mate, nullptr, &brief};
    const auto least_m = [&](const MapRoute& route) {
      double nearest_m = std::numeric_limits<double>::infinity();
      for (const MapRoute* other : {&mate, &brief}) {
        for (std::size_t step = 0; step < std::min<std::size_t>(3, other->poses.size()); ++step) {
          const auto along_m = [&](const MapRoute& way, double share) -> Eigen::Vector2d {
            const Pose2& from = step == 0 ? way.start : way.poses[step - 1];
            return (1.0 - share) * from.position_m() + share * way.poses[step].position_m();
          };
          for (int k = 0; k <= 400; ++k) {
            nearest_m = std::min(nearest_m,
                                 (along_m(route, k / 400.0) - along_m(*other, k / 400.0)).norm());
          }
        }
      }
      return nearest_m;
    };
    const double before_nats = search.value(fixed);
    const auto value_nats = [&](const MapRoute& route) {
      return search.value(std::vector<const MapRoute*>{&mate, &brief, &route}) - before_nats -
             0.5 * std::min(16.0, bench.drive.frontier_distance_m(route.poses.back().position_m()));
    };
    double best_nats = -std::numeric_limits<double>::infinity();
    bool is_close = false;
    for (const MapRoute& route : all_routes(bench, bench.starts[1])) {
      const double apart_m = least_m(route);
      is_close = is_close || std::abs(apart_m - 0.5) < 1e-4;  // m; within the sampling error
      refused += apart_m < 0.5 ? 1 : 0;
      best_nats = apart_m < 0.5 ? best_nats : std::max(best_nats, value_nats(route));
    }
    if (is_close) {
      continue;
    }
    const MapRoute plan = search.plan(bench.starts[1], fixed);
    EXPECT_EQ(plan.controls.empty(), std::isinf(best_nats)) << i;
    if (std::isfinite(best_nats)) {
      ++compared;
      EXPECT_NEAR(value_nats(plan), best_nats, 1e-9) << i;
      EXPECT_NEAR(plan.value_nats, best_nats, 1e-9) << i;
    }
  }
  EXPECT_GT(compared, 5);
  EXPECT_GT(refused, 50);
}

// If routes may end at some poses only, the search returns the best full-length route that ends at
// such a pose. If no full-length route does, it returns the best of the longest shorter routes that
// do, and the robot then stops. Without any such route, the robot does not move.
TEST(MappingSearch, EndsRoutesAtAllowedPoses) {
  test::Random random(4713);
  std::vector<int> ended(4, 0);
  for (int i = 0; i < 60; ++i) {
    Bench bench(random, 3, 0.5);
    const int steps_max = i % 4;
    const auto may_end = [&](const Pose2& at, int control, int steps) {
      const int draw = static_cast<int>(std::floor(8.0 * at.x_m)) + 3 * control + steps;
      return steps <= steps_max && draw % 3 == 0;
    };
    MappingSearchOptions options = bench.options;
    options.may_end = may_end;
    MappingSearch search(bench.views, bench.drive, options);
    const auto value_nats = [&](const MapRoute& route) {
      return search.value(std::vector<const MapRoute*>{&route}) -
             0.5 * std::min(16.0, bench.drive.frontier_distance_m(route.poses.back().position_m()));
    };
    double best_nats = -std::numeric_limits<double>::infinity();
    std::size_t steps = 0;
    for (std::size_t length = 3; length > 0 && steps == 0; --length) {
      bench.options.horizon_steps = static_cast<int>(length);
      for (const MapRoute& route : all_routes(bench, bench.starts[0])) {
        if (may_end(route.poses.back(), route.controls.back(), static_cast<int>(length))) {
          steps = length;
          best_nats = std::max(best_nats, value_nats(route));
        }
      }
    }
    const MapRoute plan = search.plan(bench.starts[0], {});
    ++ended[steps];
    ASSERT_EQ(plan.controls.size(), steps) << i;
    ASSERT_EQ(plan.poses.size(), 3U);
    const Pose2 end = steps == 0 ? plan.start : plan.poses[steps - 1];
    EXPECT_EQ(plan.start, bench.starts[0]);
    for (std::size_t step = steps; step < 3; ++step) {
      EXPECT_EQ(plan.poses[step], end) << i;
    }
    const double gain_nats = search.value(std::vector<const MapRoute*>{&plan});
    EXPECT_NEAR(plan.gain_nats, gain_nats, 1e-9) << i;
    EXPECT_NEAR(plan.value_nats, value_nats(plan), 1e-9) << i;
    if (steps > 0) {
      EXPECT_NEAR(value_nats(plan), best_nats, 1e-9) << i;
    }
    EXPECT_FALSE(plan.is_cut);
    // A search that is cut off after the greedy route also ends at an allowed pose.
    const MapRoute cut = search.plan(bench.starts[0], {}, Deadline::nodes(12));
    if (cut.controls.size() == 3) {
      EXPECT_TRUE(may_end(cut.poses.back(), cut.controls.back(), 3)) << i;
    }
  }
  for (const int count : ended) {
    EXPECT_GT(count, 3);
  }
}

// Each robot plans with the routes of the robots before it in the given order. A robot that is not
// listed has no route.
TEST(MappingSearch, PlansRobotsInTheGivenOrder) {
  test::Random random(4714);
  Bench bench(random, 2, 0.5);
  MappingSearch search(bench.views, bench.drive, bench.options);
  const MapRoute third = search.plan(bench.starts[2], {});
  const MapRoute first = search.plan(bench.starts[0], std::vector<const MapRoute*>{&third});
  const std::vector<MapRoute> routes =
      search.coordinate_descent(bench.starts, std::vector<int>{2, 0});
  ASSERT_EQ(routes.size(), 4U);
  EXPECT_EQ(routes[2].controls, third.controls);
  EXPECT_EQ(routes[0].controls, first.controls);
  EXPECT_EQ(routes[0].gain_nats, first.gain_nats);
  EXPECT_TRUE(routes[1].poses.empty() && routes[3].poses.empty());
}

TEST(MappingSearch, StaysWhenNoStepIsAllowed) {
  OccupancyBelief belief(kGrid, 3.0);
  for (int cell = 0; cell < kGrid.size(); ++cell) {
    belief.add_log_odds(cell, 9.0);
  }
  ViewTable views(belief, {16, 2.0 * kPi, 0.0, 1.5, 0.01}, {});
  const DriveMap drive(belief, {});
  MappingSearchOptions options;
  options.controls = {{1.0, 0.0}};
  const MapRoute route = MappingSearch(views, drive, options).plan({4.0, 4.0, 1.0}, {});
  EXPECT_TRUE(route.controls.empty());
  ASSERT_EQ(route.poses.size(), 4U);
  EXPECT_EQ(route.poses[3], (Pose2{4.0, 4.0, 1.0}));
  options.controls.clear();
  EXPECT_THROW(MappingSearch(views, drive, options), UsageError);
}

TEST(CoordinateDescent, IsAtLeastHalfOfTheBestTeamOnAMap) {
  test::Random random(4706);
  double worst_ratio = 1.0;
  for (int i = 0; i < 25; ++i) {
    Bench bench(random, 2, 0.0);
    MappingSearch search(bench.views, bench.drive, bench.options);
    const auto starts = std::span(bench.starts).first(2);
    const std::vector<MapRoute> greedy = search.coordinate_descent(starts, std::vector<int>{0, 1});
    double best_nats = 0.0;
    for (const MapRoute& a : all_routes(bench, starts[0])) {
      for (const MapRoute& b : all_routes(bench, starts[1])) {
        best_nats = std::max(best_nats, search.value(std::vector<const MapRoute*>{&a, &b}));
      }
    }
    const double greedy_nats = search.value(pointers(greedy));
    ASSERT_LE(greedy_nats, best_nats + 1e-9);
    ASSERT_GE(greedy_nats, 0.5 * best_nats);
    worst_ratio = std::min(worst_ratio, best_nats > 0.0 ? greedy_nats / best_nats : 1.0);
  }
  EXPECT_LT(worst_ratio, 1.0) << "the instances are too easy";
}

TEST(ResilientMapping, WithoutAttacksEqualsCoordinateDescent) {
  PlannedBench all(4707);
  MappingSearch& search = all.search;
  const std::vector<MapRoute>& plain = all.routes;
  const std::vector<MapRoute> resilient = plan_mapping_resiliently(search, all.bench.starts, 0);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(resilient[i].controls, plain[i].controls);
  }
}

TEST(ResilientMapping, KeepsBestStandAloneRoutesOfBaitAndPlansTheRest) {
  test::Random random(4708);
  for (int i = 0; i < 20; ++i) {
    Bench bench(random, 2, 0.5);
    MappingSearch search(bench.views, bench.drive, bench.options);
    std::vector<MapRoute> alone;
    std::vector<int> order{0, 1, 2, 3};
    for (const Pose2& start : bench.starts) {
      alone.push_back(search.plan(start, {}));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return alone[static_cast<std::size_t>(a)].gain_nats >
             alone[static_cast<std::size_t>(b)].gain_nats;
    });
    std::vector<int> rest{order[2], order[3]};
    std::sort(rest.begin(), rest.end());
    const std::vector<MapRoute> without = search.coordinate_descent(bench.starts, rest);
    const std::vector<MapRoute> plan = plan_mapping_resiliently(search, bench.starts, 2);
    for (std::size_t robot = 0; robot < 4; ++robot) {
      const bool is_bait =
          std::find(rest.begin(), rest.end(), static_cast<int>(robot)) == rest.end();
      EXPECT_EQ(plan[robot].controls, (is_bait ? alone : without)[robot].controls);
      EXPECT_EQ(plan[robot].nodes, alone[robot].nodes + (is_bait ? 0 : without[robot].nodes));
    }
  }
}

TEST(ResilientMapping, KeepsItsGuaranteeAgainstTheWorstAttack) {
  test::Random random(4709);
  for (int i = 0; i < 6; ++i) {
    Bench bench(random, 1, 0.0);
    MappingSearch search(bench.views, bench.drive, bench.options);
    const auto starts = std::span(bench.starts).first(3);
    const auto after_attack_nats = [&](std::vector<const MapRoute*> team) {
      double least_nats = std::numeric_limits<double>::infinity();
      for (const MapRoute*& lost : team) {
        const MapRoute* const kept = std::exchange(lost, nullptr);
        least_nats = std::min(least_nats, search.value(team));
        lost = kept;
      }
      return least_nats;
    };
    double best_nats = 0.0;
    for (const MapRoute& a : all_routes(bench, starts[0])) {
      for (const MapRoute& b : all_routes(bench, starts[1])) {
        for (const MapRoute& c : all_routes(bench, starts[2])) {
          best_nats = std::max(best_nats, after_attack_nats({&a, &b, &c}));
        }
      }
    }
    const std::vector<MapRoute> plan = plan_mapping_resiliently(search, starts, 1);
    // Theorem 1 with α = 1 and coordinate descent guarantees the share ½ · 1/(1 + α).
    ASSERT_GE(after_attack_nats(pointers(plan)), 0.25 * best_nats);
  }
}

}  // namespace
}  // namespace vantage::planner
