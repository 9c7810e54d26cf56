// Compares motion and stopping of rovers with closed forms.

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "sim/rover/rover.hpp"

namespace vantage::sim {
namespace {

constexpr double kDtS = 0.005;

RoverState drive(RoverState state, const RoverCommand& command, double seconds,
                 const RoverParameters& parameters = {}) {
  for (int i = 0; i < std::lround(seconds / kDtS); ++i) {
    state = step_rover(state, command, parameters, kDtS);
  }
  return state;
}

// Speed rises at 1 m/s² and falls at 2 m/s², and the yaw rate changes at 8 rad/s². The start and
// end values are arbitrary.
TEST(RoverModel, RampsAtTheStatedRates) {
  struct Row {
    double from, wish, after_s, expected;
  };
  for (const Row& row :
       {Row{0.2, 1.0, 0.5, 0.7}, Row{0.2, 1.0, 0.9, 1.0}, Row{1.2, 0.3, 0.25, 0.7},
        Row{1.2, 0.3, 0.6, 0.3}, Row{1.2, -5.0, 0.5, 0.2}, Row{1.2, -5.0, 1.0, 0.0},
        Row{1.0, 9.0, 1.0, 1.4}, Row{0.5, 0.5, 1.0, 0.5}}) {
    EXPECT_NEAR(drive({{}, row.from, 0.0}, {row.wish, 0.0}, row.after_s).speed_mps, row.expected,
                1e-9)
        << row.from << " to " << row.wish;
  }
  for (const double side : {1.0, -1.0}) {
    for (const Row& row : {Row{-1.0, 1.0, 0.1, -0.2}, Row{-1.0, 1.0, 0.5, 1.0},
                           Row{1.0, 0.25, 0.05, 0.6}, Row{0.0, 9.0, 1.0, 2.0}}) {
      const RoverState state =
          drive({{}, 0.0, side * row.from}, {0.0, side * row.wish}, row.after_s);
      EXPECT_NEAR(state.yaw_rate_radps, side * row.expected, 1e-9)
          << row.from << " to " << row.wish;
    }
  }
}

// One step uses the mean speed and mean yaw rate, along the heading in the middle of the step.
TEST(RoverModel, MovesAlongTheChordOfItsArc) {
  const RoverState from{{1.0, -2.0, 3.0}, 0.8, 1.5};
  for (const double side : {1.0, -1.0}) {
    const RoverState mirrored{{1.0, side * -2.0, side * 3.0}, 0.8, side * 1.5};
    const RoverState to = step_rover(mirrored, {1.4, side * 2.0}, {}, 0.05);
    EXPECT_NEAR(to.speed_mps, 0.85, 1e-12);
    EXPECT_NEAR(to.yaw_rate_radps, side * 1.9, 1e-12);
    const double turned_rad = 0.05 * 1.7;
    const double way_m = 0.05 * 0.825;
    const double chord_rad = from.world_from_body.yaw_rad + 0.5 * turned_rad;
    EXPECT_NEAR(to.world_from_body.x_m, 1.0 + way_m * std::cos(chord_rad), 1e-12);
    EXPECT_NEAR(to.world_from_body.y_m, side * (-2.0 + way_m * std::sin(chord_rad)), 1e-12);
    EXPECT_NEAR(to.world_from_body.yaw_rad, side * (3.0 + turned_rad), 1e-12);
    const double wrapped_rad = drive(mirrored, {0.8, side * 1.5}, 1.0).world_from_body.yaw_rad;
    EXPECT_NEAR(wrapped_rad, side * (4.5 - 2.0 * kPi), 1e-9) << "across ±π";
  }
}

// A commanded rover drives on for one period and then stops within v²/2b. Its turn ends during the
// stop.
TEST(StoppingPath, ConsistsOfOnePeriodAndTheBrakingPath) {
  for (const double period_s : {0.05, 0.12, 0.15}) {
    const StoppingPath path({{}, 1.0, 0.0}, {1.0, 0.0}, {}, period_s);
    EXPECT_NEAR(path.points_m().back().x(), period_s + 0.25, 1e-9) << period_s;
    EXPECT_NEAR(path.reach_m(), period_s + 0.25, 1e-9);
    EXPECT_EQ(path.points_m().front(), Eigen::Vector2d::Zero());
    // The pieces of the path are at most 5 cm long at this speed.
    for (std::size_t k = 1; k < path.points_m().size(); ++k) {
      EXPECT_LE((path.points_m()[k] - path.points_m()[k - 1]).norm(), 0.05 + 1e-9);
    }
    // Rounding may add one piece at the end.
    const std::size_t expected = 1 + (period_s > 0.06 ? 3 : 1) + 10;
    EXPECT_GE(path.points_m().size(), expected);
    EXPECT_LE(path.points_m().size(), expected + 1);
  }
  const StoppingPath standing({{3.0, 4.0, 1.0}, 0.0, 0.0}, {0.0, 2.0}, {}, 0.05);
  EXPECT_EQ(standing.points_m().back(), Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(standing.reach_m(), 0.0);
  EXPECT_EQ(standing.points_m().size(), 2u);
}

TEST(StoppingPath, ReachesItsFarthestPointAndEnds) {
  // The rover turns in a circle and returns to its start.
  RoverParameters slippery;
  slippery.brake_mps2 = 0.3;
  slippery.yaw_acceleration_radps2 = 0.5;
  slippery.yaw_rate_max_radps = 6.0;
  const StoppingPath path({{}, 1.0, 6.0}, {1.0, 6.0}, slippery, 0.8);
  double farthest_m = 0.0;
  for (const Eigen::Vector2d& point_m : path.points_m()) {
    farthest_m = std::max(farthest_m, point_m.norm());
  }
  EXPECT_EQ(path.reach_m(), farthest_m);
  EXPECT_GT(path.reach_m(), path.points_m().back().norm());
  slippery.brake_mps2 = 0.01;  // m/s²; the stop would take 100 s
  EXPECT_EQ(StoppingPath({{}, 1.0, 0.0}, {}, slippery, 0.05).points_m().size(), 48u);
}

/// Returns the stopping path from (x, y) at 1 m/s along the heading: 0.05 m at constant speed, then
/// 0.25 m of braking.
StoppingPath stop_from(double x_m, double y_m, double yaw_rad) {
  return {{{x_m, y_m, yaw_rad}, 1.0, 0.0}, {1.0, 0.0}, {}, 0.05};
}

TEST(StoppingPathDistance, IsExactAndSymmetric) {
  const StoppingPath along = stop_from(0.0, 0.0, 0.0);  // from (0, 0) to (0.3, 0)
  const StoppingPath standing({{0.12, 0.4, 0.0}, 0.0, 0.0}, {}, {}, 0.05);
  struct Row {
    StoppingPath other;
    double distance_m;
  };
  for (const Row& row :
       {Row{standing, 0.4}, Row{stop_from(0.0, 0.5, 0.0), 0.5}, Row{stop_from(0.0, -0.5, kPi), 0.5},
        Row{stop_from(-0.4, 0.0, kPi), 0.4},       // behind the start, driving away
        Row{stop_from(0.7, 0.3, kPi / 2), 0.5},    // next to the end; 3-4-5 triangle
        Row{stop_from(0.15, 0.6, -kPi / 2), 0.3},  // towards the middle of the path
        Row{stop_from(1.0, 0.0, kPi), 0.4}}) {     // from the opposite direction
    EXPECT_NEAR(distance_m(along, row.other), row.distance_m, 1e-9);
    EXPECT_NEAR(distance_m(row.other, along), row.distance_m, 1e-9);
  }
  // Sampled points of two crossing paths are at most half a piece apart.
  EXPECT_LT(distance_m(along, stop_from(0.16, 0.1, -kPi / 2)), 0.025);
}

TEST(StoppingPathDistance, IsALowerBoundWhenFar) {
  const StoppingPath along = stop_from(0.0, 0.0, 0.0);
  // The rovers drive towards each other: the result is the distance minus both stopping distances.
  const double found_m = distance_m(along, stop_from(3.0, 0.0, kPi));
  EXPECT_NEAR(found_m, 3.0 - 0.3 - 0.3, 1e-9);
  EXPECT_NEAR(distance_m(along, stop_from(0.0, 2.7, 0.0)), 2.1, 1e-9)
      << "beyond 2 m, a lower bound";
  EXPECT_NEAR(distance_m(along, stop_from(0.0, 2.5, 0.0)), 2.5, 1e-9) << "exact below";
}

}  // namespace
}  // namespace vantage::sim
