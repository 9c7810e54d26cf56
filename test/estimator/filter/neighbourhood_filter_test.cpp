#include <algorithm>

#include <gtest/gtest.h>

#include "estimator/app/replay_node.hpp"
#include "test/estimator/filter_support.hpp"

// Tests a filter that is limited to the neighbourhood of its robot.

namespace vantage::estimator {
namespace {

using namespace test::words;

constexpr double kNear_m = 15.0;

FilterSpec near_spec(double neighbourhood_m) {
  models::SensorModel sensor;
  sensor.kind = SensorKind::kPosition;
  FilterSpec spec = open_spec({TargetKind::kRandomWalk, 2, 0.01}, sensor, 200);
  spec.sensor.range_max_m = 8.0;
  spec.world.bounds = {{-200.0, -200.0}, {200.0, 200.0}};
  spec.estimator.grid_resolution_m = 2.0;
  spec.neighbourhood_m = neighbourhood_m;
  spec.communication_range_m = 12.0;
  return spec;
}

/// Returns targets 5 m apart along x, from 0.
std::vector<Eigen::Vector2d> row_of_targets() {
  std::vector<Eigen::Vector2d> row;
  for (int i = 0; i < 30; ++i) {
    row.emplace_back(5.0 * i, 0.0);
  }
  return row;
}

models::RobotMeasurement look_in_range(const FilterSpec& spec, int step,
                                       const models::Viewpoint& from, std::mt19937_64& rng) {
  models::RobotMeasurement look = look_at(spec.sensor, instant(step), from, row_of_targets(), rng);
  std::erase_if(look.detections, [&](const models::Detection& each) {
    return std::abs(5.0 * each.target_id - from.world_from_body.x_m) > spec.sensor.range_max_m;
  });
  return look;
}

TEST(NeighbourhoodFilter, EqualsTheFullFilterInItsNeighbourhood) {
  FilterSpec near = near_spec(kNear_m);
  DistributedFilter some(near);
  DistributedFilter all(near_spec(0.0));
  std::mt19937_64 rng(4);
  for (int step = 0; step < 60; ++step) {
    const models::Viewpoint from = at(2.0 * step, 0.0);
    const models::RobotMeasurement look = look_in_range(near, step, from, rng);
    const models::RobotBelief sent = take_step(some, instant(step), from, {look});
    const models::RobotBelief whole = take_step(all, instant(step), from, {look});
    for (const models::TargetBelief& target : whole.targets) {
      const double away_m = std::abs(5.0 * target.target_id - 2.0 * step);
      const auto found =
          std::find_if(sent.targets.begin(), sent.targets.end(),
                       [&](const auto& each) { return each.target_id == target.target_id; });
      if (std::abs(away_m - kNear_m) > 1.0) {  // not near the limit
        ASSERT_EQ(found != sent.targets.end(), away_m < kNear_m) << step;
      }
      if (found != sent.targets.end()) {
        EXPECT_EQ(found->information.matrix, target.information.matrix);
      }
    }
    EXPECT_LE(sent.grid.size(), 23 * 23) << "2.5 neighbourhoods in cells of 2 m";
    for (int index = 0; index < whole.grid.size(); ++index) {
      const int there = sent.grid.index_of(whole.grid.centre_m(index));
      const bool is_near =
          (whole.grid.centre_m(index) - from.world_from_body.position_m()).cwiseAbs().maxCoeff() <=
          kNear_m;
      ASSERT_TRUE(there >= 0 || !is_near);
      if (is_near) {
        ASSERT_EQ(sent.last_seen_utime[static_cast<std::size_t>(there)],
                  whole.last_seen_utime[static_cast<std::size_t>(index)]);
      }
    }
  }
}

TEST(NeighbourhoodFilter, ContinuesExactlyFromAnyOfItsBeliefs) {
  const FilterSpec spec = near_spec(kNear_m);
  DistributedFilter first(spec);
  DistributedFilter second(spec);
  std::mt19937_64 rng(4);
  models::RobotBelief last;
  for (int step = 0; step < 60; ++step) {
    const models::Viewpoint from = at(2.0 * step, 0.0);
    const models::RobotMeasurement look = look_in_range(spec, step, from, rng);
    if (step % 7 == 3) {
      second.rebase(last);
    }
    last = take_step(first, instant(step), from, {look});
    EXPECT_TRUE(same_content(last, take_step(second, instant(step), from, {look}), 0.0)) << step;
  }
}

TEST(NeighbourhoodFilter, FusesTeammatesBeliefsInTheSharedArea) {
  const FilterSpec spec = near_spec(kNear_m);
  FilterSpec other = spec;
  other.robot = "Q2";
  other.start = at(10.0, 9.0);
  DistributedFilter own(spec);
  DistributedFilter theirs(other);
  std::mt19937_64 rng(4);
  const models::RobotBelief sent =
      take_step(theirs, instant(0), at(10.0, 4.0), {look_in_range(spec, 0, at(10.0, 4.0), rng)});
  EXPECT_FALSE(sent.grid == own.grid().geometry());
  const models::RobotBelief belief = take_step(own, instant(1), at(0.0, 0.0), {}, {sent});
  EXPECT_EQ(own.counters().grid_mismatches, 0);
  ASSERT_GE(belief.targets.size(), 2U) << "those at 5 and 10 m; the one at 15 m may be either";
  EXPECT_LE(belief.targets.size(), 3U);
  const int seen = own.grid().geometry().index_of({9.0, 3.0});
  EXPECT_NE(own.grid().last_seen_utime()[static_cast<std::size_t>(seen)], 0);
  models::RobotBelief foreign = sent;
  foreign.grid.origin_m.x() += 0.5;
  take_step(own, instant(2), at(0.0, 0.0), {}, {foreign});
  EXPECT_EQ(own.counters().grid_mismatches, 1);
}

// The grid stays the same while the robot moves in a square of half the neighbourhood. It contains
// the neighbourhood of each position in this square.
TEST(NeighbourhoodFilter, MovesItsLocalGridRarely) {
  const auto grid_at = [](double x_m, double y_m) {
    FilterSpec spec = near_spec(kNear_m);
    spec.start = at(x_m, y_m);
    return DistributedFilter(spec).grid().geometry();
  };
  const double half_m = 0.25 * kNear_m;
  for (const double middle_m : {-75.0, 0.0, 37.5}) {
    const models::GridGeometry grid = grid_at(middle_m, -middle_m);
    for (const double side : {-1.0, 1.0}) {
      EXPECT_EQ(grid_at(middle_m + side * (half_m - 0.01), -middle_m), grid);
      EXPECT_EQ(grid_at(middle_m, -middle_m + side * (half_m - 0.01)), grid);
      EXPECT_NE(grid_at(middle_m + side * (half_m + 0.01), -middle_m), grid);
      EXPECT_NE(grid_at(middle_m, -middle_m + side * (half_m + 0.01)), grid);
      const double far_m = side * (half_m + kNear_m - 0.01);
      EXPECT_GE(grid.index_of({middle_m + far_m, -middle_m}), 0);
      EXPECT_GE(grid.index_of({middle_m, -middle_m + far_m}), 0);
    }
    EXPECT_LE(grid.columns, 20) << "2.5 neighbourhoods of 15 m in cells of 2 m";
    EXPECT_LE(grid.rows, 20);
  }
  EXPECT_EQ(DistributedFilter(near_spec(0.0)).grid().geometry().size(), 200 * 200);
}

TEST(NeighbourhoodFilter, DropsATargetAtItsEdge) {
  for (const Eigen::Vector2d& towards : {Eigen::Vector2d(0.6, -0.8), Eigen::Vector2d(-1.0, 0.0)}) {
    DistributedFilter filter(near_spec(kNear_m));
    const Eigen::Vector2d here_m(3.0, -4.0);
    models::RobotBelief before;
    before.stamp.time = instant(0);
    for (const double away_m : {kNear_m - 0.01, kNear_m + 0.01}) {
      const Eigen::Vector2d there_m = here_m + away_m * towards;
      before.targets.push_back(
          {static_cast<int>(before.targets.size()),
           models::to_information({there_m, Eigen::Matrix2d::Identity()}).value(), instant(0)});
    }
    filter.rebase(before);
    const models::RobotBelief after = take_step(filter, instant(1), at(3.0, -4.0), {});
    ASSERT_EQ(after.targets.size(), 1U);
    EXPECT_EQ(after.targets[0].target_id, 0);
  }
}

}  // namespace
}  // namespace vantage::estimator
