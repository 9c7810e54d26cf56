// Tests start positions of targets, and motion of targets that drift or drive.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "sim/rover/drifters.hpp"
#include "sim/rover/fleet.hpp"
#include "sim/rover/starts.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::sim {
namespace {

constexpr double kDtS = 0.005;

/// Returns a scenario with an empty room of the given size and without robots. It has one target
/// per radius in `radii_m`.
scenario::Scenario room_of(double side_m, const std::vector<double>& radii_m) {
  scenario::Scenario out;
  out.world.bounds = {{-1.0, 3.0}, {-1.0 + side_m, 3.0 + side_m}};
  for (std::size_t i = 0; i < radii_m.size(); ++i) {
    scenario::TargetSpec target;
    target.name = "T" + std::to_string(i);
    target.id = static_cast<int>(i);
    target.radius_m = radii_m[i];
    out.targets.push_back(target);
  }
  return out;
}

double least_gap_m(const scenario::Scenario& scenario, const std::vector<Pose2>& starts) {
  double gap_m = 1e9;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      gap_m = std::min(gap_m, (starts[i].position_m() - starts[j].position_m()).norm() -
                                  scenario.targets[i].radius_m - scenario.targets[j].radius_m);
    }
  }
  return gap_m;
}

// With enough space, targets of any size start 30 cm from each other, 10 cm from walls and 1 m from
// robots. The starts cover each quarter of the room and each quarter of the headings.
TEST(TargetStarts, KeepDistancesAndCoverTheWorld) {
  scenario::Scenario scenario = room_of(6.0, {0.1, 0.5, 0.3});
  scenario.robots = {test::lab_scenario().robots[0], test::lab_scenario().robots[1]};
  scenario.robots[0].start = {0.0, 4.0, 0.0};
  scenario.robots[1].start = {4.0, 8.0, 0.0};
  int quarters[4] = {};
  int headings[4] = {};
  double gap_m = 1e9;
  double wall_m = 1e9;
  double robot_m = 1e9;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::vector<Pose2> starts = target_starts(scenario, seed);
    gap_m = std::min(gap_m, least_gap_m(scenario, starts));
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const Eigen::Vector2d place_m = starts[i].position_m();
      wall_m = std::min(
          wall_m, models::clearance_m(scenario.world, place_m) - scenario.targets[i].radius_m);
      for (const scenario::RobotSpec& robot : scenario.robots) {
        robot_m = std::min(robot_m, (robot.start.position_m() - place_m).norm());
      }
      ++quarters[(place_m.x() < 2.0 ? 0 : 1) + (place_m.y() < 6.0 ? 0 : 2)];
      ASSERT_LE(std::abs(starts[i].yaw_rad), kPi);
      ++headings[static_cast<int>((starts[i].yaw_rad + kPi) / (kPi / 2.0)) % 4];
    }
  }
  EXPECT_GE(gap_m, 0.3);
  EXPECT_LT(gap_m, 0.35) << "not more than required";
  EXPECT_GE(wall_m, 0.1);
  EXPECT_LT(wall_m, 0.12);
  EXPECT_GE(robot_m, 1.0);
  EXPECT_LT(robot_m, 1.03);
  for (int k = 0; k < 4; ++k) {
    EXPECT_GT(quarters[k], 120) << k;  // a quarter of 900 starts is 225
    EXPECT_GT(headings[k], 160) << k;
  }
}

TEST(TargetStarts, UseTheScenariosStartsFirst) {
  scenario::Scenario scenario = room_of(2.0, {0.2, 0.2, 0.2});
  scenario.targets[2].start = Pose2{0.0, 4.0, 1.5};  // in the middle of the room
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<Pose2> starts = target_starts(scenario, seed);
    ASSERT_EQ(starts.size(), 3u);
    EXPECT_EQ(starts[2], *scenario.targets[2].start);
    EXPECT_GE(least_gap_m(scenario, starts), 0.3);
  }
}

// One target is fixed in a corner, `from_m` from both walls. The other one must start in the
// opposite corner. Clearances of 10 cm to walls and 0.3 m to the target do not fit, but half or a
// quarter of these do.
TEST(TargetStarts, HaveLessClearanceOrAreRefusedInASmallRoom) {
  struct Row {
    double from_m, least_m, most_m;
  };
  for (const Row& row : {Row{0.23, 0.15, 0.3}, Row{0.37, 0.075, 0.15}}) {
    scenario::Scenario tight = room_of(1.0, {0.2, 0.2});
    tight.targets[0].start = Pose2{-1.0 + row.from_m, 3.0 + row.from_m, 0.0};
    double wall_m = 1e9;
    double gap_m = 1e9;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const std::vector<Pose2> starts = target_starts(tight, seed);
      gap_m = std::min(gap_m, least_gap_m(tight, starts));
      wall_m = std::min(wall_m, models::clearance_m(tight.world, starts[1].position_m()) - 0.2);
    }
    EXPECT_GE(gap_m, row.least_m);
    EXPECT_LT(gap_m, row.most_m);
    EXPECT_GE(wall_m, row.least_m / 3.0) << "the distance from walls shrinks as well";
    EXPECT_LT(wall_m, row.most_m / 3.0);
  }
  scenario::Scenario full = room_of(0.9, {0.25, 0.25, 0.25});
  full.targets[0].start = Pose2{-0.74, 3.26, 0.0};
  full.targets[1].start = Pose2{-0.36, 3.64, 0.0};
  try {
    target_starts(full, 1);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()),
              "target T2: no free start position left: 2 of 3 targets have one");
  }
}

TEST(Drifters, RefuseInvalidMotion) {
  const models::World world = room_of(6.0, {}).world;
  EXPECT_NO_THROW(Drifters(world, {}, 0.0, 0.1, 1));
  EXPECT_THROW(Drifters(world, {}, -1e-9, 1.0, 1), UsageError);
  EXPECT_THROW(Drifters(world, {}, 0.1, 0.0, 1), UsageError);
  EXPECT_THROW(Drifters(world, {}, 0.1, -1.0, 1), UsageError);
}

// Without noise targets are stationary. With noise each target moves independently, within the
// limits given by its own radius.
TEST(Drifters, KeepAMillimetreFromEachOtherAndWalls) {
  models::World world;
  world.bounds = {{0.0, 0.0}, {1.2, 1.2}};
  const std::vector<Disc> starts{{{0.25, 0.25}, 0.1}, {{0.8, 0.8}, 0.25}};
  Drifters still(world, starts, 0.0, 1.0, 5);
  still.step(kDtS);
  EXPECT_EQ(still.disc(0).centre_m, starts[0].centre_m);
  EXPECT_EQ(still.velocity_mps(1), Eigen::Vector2d::Zero());
  Drifters drifters(world, starts, 0.2, 0.3, 5);
  double pair_m = 1e9;
  double wall_m[2] = {1e9, 1e9};
  double fastest_mps = 0.0;
  for (int step = 0; step < 60'000; ++step) {
    drifters.step(kDtS);
    pair_m = std::min(pair_m, (drifters.disc(0).centre_m - drifters.disc(1).centre_m).norm());
    for (std::size_t i = 0; i < 2; ++i) {
      wall_m[i] = std::min(wall_m[i], models::clearance_m(world, drifters.disc(i).centre_m));
      fastest_mps = std::max(fastest_mps, drifters.velocity_mps(i).norm());
    }
  }
  // A step is at most 1.5 mm long.
  EXPECT_GE(pair_m, 0.351);
  EXPECT_LT(pair_m, 0.3517);
  EXPECT_GE(wall_m[0], 0.101);
  EXPECT_LT(wall_m[0], 0.1017);
  EXPECT_GE(wall_m[1], 0.251);
  EXPECT_LT(wall_m[1], 0.2517);
  EXPECT_LE(fastest_mps, 0.3 + 1e-12);
  EXPECT_GT(fastest_mps, 0.299);
}

scenario::TargetTruthSpec truth_of(double min_mps, double max_mps) {
  scenario::TargetTruthSpec out;
  out.speed_min_mps = min_mps;
  out.speed_max_mps = max_mps;
  out.pause_max_s = 1.0;
  return out;
}

TEST(RoverFleet, AcceptsOnlyDrivableSpeeds) {
  const models::World world = room_of(6.0, {}).world;
  const auto is_taken = [&](double min_mps, double max_mps) {
    try {
      RoverFleet(world, truth_of(min_mps, max_mps), {}, 1);
    } catch (const UsageError&) {
      return false;
    }
    return true;
  };
  EXPECT_TRUE(is_taken(0.1, 1.4));
  EXPECT_TRUE(is_taken(1.4, 1.4));
  EXPECT_FALSE(is_taken(0.0, 1.0));
  EXPECT_FALSE(is_taken(0.6, 0.5));
  EXPECT_FALSE(is_taken(0.1, 1.41));
}

/// Calls look() every 50 ms for `seconds`, with one rover in an empty room.
template <class Look>
void watch(RoverFleet& fleet, double seconds, const Look& look) {
  for (int k = 0; k < std::lround(seconds / RoverFleet::kDecisionPeriodS); ++k) {
    fleet.decide(RoverFleet::kDecisionPeriodS);
    for (int i = 0; i < 10; ++i) {
      fleet.step(kDtS);
    }
    look();
  }
}

// The rover drives legs with speeds between the limits. Pauses between legs last at most the
// configured time.
TEST(RoverFleet, HasTheStatedSpeedsAndPauses) {
  const models::World world = room_of(12.0, {}).world;
  RoverFleet fleet(world, truth_of(0.4, 0.8), {{{5.0, 9.0, 0.0}, 0.2}}, 3);
  double slowest_leg_mps = 1e9;
  double fastest_leg_mps = 0.0;
  double fastest_mps = 0.0;
  double standing_s = 0.0;
  double longest_s = 0.0;
  std::int64_t reached = 0;
  watch(fleet, 800.0, [&] {
    const RoverState& state = fleet.state(0);
    fastest_mps = std::max(fastest_mps, state.speed_mps);
    standing_s = state.speed_mps == 0.0 && state.yaw_rate_radps == 0.0
                     ? standing_s + RoverFleet::kDecisionPeriodS
                     : 0.0;
    longest_s = std::max(longest_s, standing_s);
    if (fleet.way_points_reached() > reached) {
      reached = fleet.way_points_reached();
      slowest_leg_mps = std::min(slowest_leg_mps, fastest_mps);
      fastest_leg_mps = std::max(fastest_leg_mps, fastest_mps);
      fastest_mps = 0.0;
    }
  });
  EXPECT_GT(reached, 40);
  EXPECT_EQ(fleet.way_points_abandoned(), 0);
  EXPECT_LE(fastest_leg_mps, 0.8);
  EXPECT_GT(fastest_leg_mps, 0.76);
  EXPECT_LT(slowest_leg_mps, 0.45);
  EXPECT_GT(slowest_leg_mps, 0.25);  // a short leg may end before the rover reaches full speed
  EXPECT_LE(longest_s, 1.0 + 0.11);
  EXPECT_GT(longest_s, 0.6);  // s; the rover must stop first
}

// Rovers of different sizes in a small room do not touch a wall or each other. Each has its own
// radius.
TEST(RoverFleet, RoversOfDifferentSizesTouchNothing) {
  const models::World world = room_of(3.0, {}).world;
  const std::vector<RoverFleet::Start> starts{
      {{-0.5, 3.5, 0.0}, 0.1}, {{1.0, 5.0, 0.0}, 0.3}, {{-0.4, 5.4, 1.0}, 0.2}};
  RoverFleet fleet(world, truth_of(0.3, 0.6), starts, 9);
  double gap_m[3] = {1e9, 1e9, 1e9};
  double wall_m[3] = {1e9, 1e9, 1e9};
  watch(fleet, 150.0, [&] {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d place_m = fleet.state(i).world_from_body.position_m();
      EXPECT_EQ(fleet.radius_m(i), starts[i].radius_m);
      wall_m[i] = std::min(wall_m[i], models::clearance_m(world, place_m) - fleet.radius_m(i));
      const std::size_t j = (i + 1) % 3;
      const Eigen::Vector2d other_m = fleet.state(j).world_from_body.position_m();
      gap_m[i] =
          std::min(gap_m[i], (place_m - other_m).norm() - fleet.radius_m(i) - fleet.radius_m(j));
    }
  });
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(gap_m[i], 0.0) << i;
    EXPECT_LT(gap_m[i], 0.3) << i << ": rovers come near the circle";
    EXPECT_GT(wall_m[i], 0.0) << i;
    EXPECT_LT(wall_m[i], 0.3) << i;
  }
  EXPECT_GT(fleet.way_points_reached(), 10);
}

// No rover enters the reserved circles. A rover inside one does not come nearer to the centre. When
// the circles are released, rovers use these areas again.
TEST(RoverFleet, AvoidsReservedDiscs) {
  const models::World world = room_of(4.0, {}).world;
  const Eigen::Vector2d first_m(0.0, 4.0);
  const Eigen::Vector2d second_m(2.0, 6.0);
  RoverFleet fleet(world, truth_of(0.3, 0.6), {{{0.0, 4.6, 0.0}, 0.2}, {{2.0, 4.0, 0.0}, 0.2}}, 2);
  fleet.keep_out({first_m, second_m}, 0.8);
  double nearest_m[2][2] = {{1e9, 1e9}, {1e9, 1e9}};
  const auto look = [&] {
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector2d place_m = fleet.state(i).world_from_body.position_m();
      nearest_m[i][0] = std::min(nearest_m[i][0], (place_m - first_m).norm());
      nearest_m[i][1] = std::min(nearest_m[i][1], (place_m - second_m).norm());
    }
  };
  watch(fleet, 100.0, look);
  EXPECT_GE(nearest_m[0][0], 0.6 - 1e-3) << "started inside the circle";
  EXPECT_GE(nearest_m[0][1], 0.8 - 1e-3);
  EXPECT_GE(nearest_m[1][0], 0.8 - 1e-3);
  EXPECT_GE(nearest_m[1][1], 0.8 - 1e-3);
  EXPECT_GT(fleet.way_points_reached(), 6);
  fleet.keep_out({}, 0.8);
  watch(fleet, 100.0, look);
  EXPECT_LT(std::min(nearest_m[0][0], nearest_m[1][0]), 0.5);
  EXPECT_LT(std::min(nearest_m[0][1], nearest_m[1][1]), 0.5);
}

// At full speed, a piece of the path is seven centimetres long. A reserved circle may lie next to
// the middle of a piece.
TEST(RoverFleet, AvoidsSmallReservedDiscs) {
  const models::World world = room_of(3.0, {}).world;
  constexpr double kNearM = 0.045;
  std::vector<Eigen::Vector2d> places_m;
  for (int k = 0; k < 25; ++k) {
    places_m.emplace_back(-0.5 + 0.5 * (k % 5), 3.5 + 0.5 * (k / 5));
  }
  RoverFleet fleet(world, truth_of(1.3, 1.4), {{{0.25, 4.25, 0.0}, 0.1}}, 4);
  fleet.keep_out(places_m, kNearM);
  double nearest_m = 1e9;
  double fastest_mps = 0.0;
  for (int step = 0; step < 40'000; ++step) {
    if (step % 10 == 0) {
      fleet.decide(RoverFleet::kDecisionPeriodS);
    }
    fleet.step(kDtS);
    fastest_mps = std::max(fastest_mps, fleet.state(0).speed_mps);
    for (const Eigen::Vector2d& place_m : places_m) {
      const double away_m = (fleet.state(0).world_from_body.position_m() - place_m).norm();
      nearest_m = std::min(nearest_m, away_m);
    }
  }
  EXPECT_GE(nearest_m, kNearM - 1e-3);
  EXPECT_LT(nearest_m, kNearM + 0.01) << "the rover comes near";
  EXPECT_GT(fastest_mps, 1.0);
  EXPECT_GT(fleet.way_points_reached(), 20);
}

}  // namespace
}  // namespace vantage::sim
