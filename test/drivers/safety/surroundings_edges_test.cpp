#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/surroundings.hpp"
#include "models/world/world.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"
#include "test/support/random.hpp"

// Tests both sides of the limit of each distance of Surroundings, in rooms for which the result is
// known.

namespace vantage::drivers {
namespace {

SafetyLimits bench_limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

/// Returns the limits of the bench vehicle in a room without obstacles.
SafetyLimits limits_in(const models::Rectangle& bounds) {
  SafetyLimits limits = bench_limits();
  limits.fence.bounds = bounds;
  limits.fence.obstacles.clear();
  return limits;
}

/// Returns the braking path of a vehicle that is commanded to stop at `p_m`.
BrakingPath stop_from(const Eigen::Vector3d& p_m, const Eigen::Vector3d& v_mps,
                      const SafetyLimits& limits) {
  return BrakingPath::straight(p_m, v_mps, 0.0, limits.vehicle.brake_mps2, limits.reaction_s);
}

// Two vehicles with equal speed pass each other in opposite directions. The relative motion is a
// straight line.
TEST(ComputeSurroundings, FindsTheSeparationOfAHeadOnPass) {
  const SafetyLimits limits = bench_limits();
  test::Random random(51);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d here_m = random.vector<3>(-1.0, 1.0);
    const double heading_rad = random.uniform(-kPi, kPi);
    const Eigen::Vector3d ahead(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    const Eigen::Vector3d aside(-ahead.y(), ahead.x(), 0.0);
    const Eigen::Vector3d v_mps = random.uniform(0.2, 1.0) * ahead;
    const double between_m = random.uniform(0.0, 1.5);
    const double beside_m = random.uniform(0.05, 0.4);
    OtherBody body;
    body.robot = 0;
    body.position_world_m = here_m + between_m * ahead + beside_m * aside;
    body.age_s = random.uniform(0.0, 1.5);
    const double closed_m = std::min(between_m, 2.0 * stopping_distance_m(limits, v_mps.norm()));
    const double tube_m = std::clamp(0.5 * (body.age_s - 0.1), 0.0, 0.5);
    const double least_m = std::hypot(between_m - closed_m, beside_m) - tube_m;
    // A planned velocity of the other vehicle can only reduce the predicted separation.
    const std::vector<std::pair<double, double>> ways = {
        {-1.0, -1.0}, {-1.0, 0.0}, {-1.0, 1.0}, {0.0, -1.0}, {1.0, -1.0}};
    for (const auto& [does, plans] : ways) {
      body.velocity_world_mps = does * v_mps;
      body.planned_world_mps = plans * v_mps;
      const Surroundings seen =
          compute_surroundings(here_m, stop_from(here_m, v_mps, limits), {&body, 1}, limits);
      EXPECT_NEAR(seen.separation_stop_m, least_m, 1e-9) << does << " " << plans;
    }
  }
}

// The path relative to a braking vehicle is curved. It is divided into 16 chords of less than 45
// ms, which deviate from it by at most half a millimetre.
TEST(ComputeSurroundings, FindsTheLeastSeparationToHalfAMillimetre) {
  const SafetyLimits limits = bench_limits();
  const auto speed_mps = [](test::Random& random) -> Eigen::Vector3d {
    const double heading_rad = random.uniform(-kPi, kPi);
    return random.uniform(0.3, 1.0) *
           Eigen::Vector3d(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  };
  test::Random random(52);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d here_m(0.0, -1.0, 1.0);
    const BrakingPath ours = stop_from(here_m, speed_mps(random), limits);
    OtherBody body;
    body.robot = 0;
    body.position_world_m =
        here_m + Eigen::Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 0.0);
    body.velocity_world_mps = body.planned_world_mps = speed_mps(random);
    const BrakingPath theirs = stop_from(body.position_world_m, body.velocity_world_mps, limits);
    constexpr double kStepS = 2.5e-3;
    double least_m = 1e9;
    for (double t_s = 0.0; t_s < 0.75; t_s += kStepS) {
      least_m = std::min(
          least_m, models::closest_approach_m(
                       ours.at(t_s).position_world_m, ours.at(t_s + kStepS).position_world_m,
                       theirs.at(t_s).position_world_m, theirs.at(t_s + kStepS).position_world_m));
    }
    EXPECT_NEAR(compute_surroundings(here_m, ours, {&body, 1}, limits).separation_stop_m, least_m,
                5e-4);
  }
}

// On a straight path in a convex room, the least distance to walls and ceiling is at one end of the
// path. The same applies with an additional wall across the room.
TEST(ComputeSurroundings, FindsTheLeastDistanceToWallsAtAnEnd) {
  SafetyLimits limits = limits_in({{-8.0, 3.0}, {4.5, 9.0}});
  limits.fence.ceiling_m = 2.6;
  limits.fence.obstacles.push_back({{{-10.0, -5.0}, {-5.0, 17.0}}, 2.5});
  test::Random random(55);
  const auto fence_m = [&](const Eigen::Vector3d& p_m, double radius_m) {
    return std::min({p_m.x() + 8.0 - radius_m, 4.5 - p_m.x() - radius_m, p_m.y() - 3.0 - radius_m,
                     9.0 - p_m.y() - radius_m, 2.6 - p_m.z()});
  };
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d here_m(random.uniform(-2.4, 1.9), random.uniform(3.0, 9.0),
                                 random.uniform(0.2, 2.6));
    limits.reaction_s = random.uniform(0.1, 1.0);
    const Eigen::Vector3d v_mps = random.vector<3>(-1.0, 1.0);
    const double speed_mps = v_mps.norm();
    const Eigen::Vector3d end_m =
        here_m + stopping_distance_m(limits, speed_mps) / speed_mps * v_mps;
    const double radius_m = limits.vehicle.radius_m;
    const Surroundings seen =
        compute_surroundings(here_m, stop_from(here_m, v_mps, limits), {}, limits);
    EXPECT_NEAR(seen.fence_centre_m, fence_m(here_m, 0.0), 1e-9);
    EXPECT_NEAR(seen.fence_now_m, fence_m(here_m, radius_m), 1e-9);
    EXPECT_NEAR(seen.fence_stop_m, std::min(seen.fence_now_m, fence_m(end_m, radius_m)), 1e-9);
    EXPECT_NEAR(seen.obstacle_stop_m, std::min(here_m.x(), end_m.x()) + 5.0 - radius_m, 1e-9);
  }
}

// A post as thick as 1/16 of the path length is found at every position along the path.
TEST(ComputeSurroundings, FindsAPostNextToThePath) {
  SafetyLimits limits = limits_in({{-8.0, -8.0}, {8.0, 8.0}});
  const Eigen::Vector3d here_m(1.0, -2.0, 1.0);
  for (const double v_mps : {0.5, -1.0}) {
    const double distance_m = std::copysign(stopping_distance_m(limits, std::abs(v_mps)), v_mps);
    for (double share = 0.0; share <= 1.0; share += 0.05) {
      const double post_x_m = here_m.x() + share * distance_m;
      limits.fence.obstacles = {{{{post_x_m - 0.06, -1.4}, {post_x_m + 0.06, -1.3}}, 2.5}};
      const BrakingPath way = stop_from(here_m, {v_mps, 0.0, 0.0}, limits);
      EXPECT_NEAR(compute_surroundings(here_m, way, {}, limits).obstacle_stop_m,
                  0.6 - limits.vehicle.radius_m, 1e-9);
    }
  }
}

// Several bodies pass at different times. The nearest one determines the result, in any order of
// the list.
TEST(PredictedDistance, ReturnsTheNearestBody) {
  const Eigen::Vector3d here_m(1.0, -1.0, 1.0);
  std::vector<OtherBody> others(3);
  others[0].position_world_m = {1.0, 2.0, 0.0};
  others[1].position_world_m = {4.0, -1.0, 0.0};
  others[1].velocity_world_mps = {-1.0, 0.0, 0.0};
  others[2].position_world_m = {-3.0, -0.6, 0.0};
  others[2].velocity_world_mps = {8.0, 0.0, 0.0};  // passes the vehicle and moves away
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(predicted_distance_m(here_m, others, 0.0), 3.0, 1e-12);
    EXPECT_NEAR(predicted_distance_m(here_m, others, 1.0), 0.4, 1e-12);
    std::rotate(others.begin(), others.begin() + 1, others.end());
  }
}

// A hover outside the fence gets a landing spot just inside, with its edge 0.1 m from the wall. If
// the room is too small for that, the spot is in the middle between the walls.
TEST(LandingSpot, IsMovedInsideTheFence) {
  test::Random random(53);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d low_m = random.vector<2>(-5.0, 5.0);
    const Eigen::Vector2d size_m = random.vector<2>(0.1, 2.0);
    const SafetyLimits limits = limits_in({low_m, low_m + size_m});
    const double margin_m = limits.vehicle.radius_m + 0.1;
    const Eigen::Vector3d hover_m(random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), 1.0);
    const Eigen::Vector3d spot_m = landing_spot(hover_m, {}, limits);
    EXPECT_EQ(spot_m.z(), hover_m.z());
    for (int axis = 0; axis < 2; ++axis) {
      const double from_low_m = spot_m(axis) - low_m(axis);
      const double from_high_m = low_m(axis) + size_m(axis) - spot_m(axis);
      EXPECT_GE(from_low_m, std::min(margin_m, 0.5 * size_m(axis)) - 1e-9);
      EXPECT_GE(from_high_m, std::min(margin_m, 0.5 * size_m(axis)) - 1e-9);
      const double least_m = std::min(from_low_m, from_high_m);
      EXPECT_TRUE(spot_m(axis) == hover_m(axis) || least_m <= margin_m + 1e-9);
    }
  }
}

/// A corridor with a body below the hover. It is so narrow that only two landing spots exist: 1 m
/// ahead and 1 m behind.
class Corridor {
 public:
  /// `is_turned`: the corridor runs along y instead of x.
  explicit Corridor(bool is_turned = false) : is_turned_(is_turned) {
    limits_ = limits_in(between(-7.0, 7.0, 0.38));
    others_.resize(1);
    others_[0].position_world_m = {hover_m_.x(), hover_m_.y(), 0.0};
  }

  /// Adds a wall across the corridor, from `from_m` to `to_m` ahead of the hover.
  void build(double from_m, double to_m) {
    limits_.fence.obstacles.push_back(
        {between(std::min(from_m, to_m), std::max(from_m, to_m), 1.0), 2.5});
  }
  /// Adds a body at an offset from the hover.
  void add(OtherBody body, double ahead_m, double beside_m, double above_m) {
    body.position_world_m = hover_m_ + way(ahead_m, beside_m, above_m);
    others_.push_back(body);
  }
  void ask_clearance(double clearance_m) { limits_.landing_clearance_m = clearance_m; }
  /// Returns the distance of the landing spot ahead of the hover, m; 0 if there is none.
  [[nodiscard]] double spot_m() const {
    const Eigen::Vector3d spot_m = landing_spot(hover_m_, others_, limits_) - hover_m_;
    EXPECT_NEAR(spot_m(is_turned_ ? 0 : 1), 0.0, 1e-9);
    EXPECT_EQ(spot_m.z(), 0.0);
    return spot_m(is_turned_ ? 1 : 0);
  }

 private:
  [[nodiscard]] Eigen::Vector3d way(double ahead_m, double beside_m, double above_m) const {
    return is_turned_ ? Eigen::Vector3d(beside_m, ahead_m, above_m)
                      : Eigen::Vector3d(ahead_m, beside_m, above_m);
  }
  [[nodiscard]] models::Rectangle between(double from_m, double to_m, double half_width_m) const {
    return {(hover_m_ + way(from_m, -half_width_m, 0.0)).head<2>(),
            (hover_m_ + way(to_m, half_width_m, 0.0)).head<2>()};
  }

  bool is_turned_;
  Eigen::Vector3d hover_m_{2.0, -3.0, 1.0};
  SafetyLimits limits_;
  std::vector<OtherBody> others_;
};

TEST(LandingSpot, IsOnTheSideWithAFreePath) {
  for (const bool is_turned : {false, true}) {
    EXPECT_NEAR(std::abs(Corridor(is_turned).spot_m()), 1.0, 1e-9);
    for (const double side : {1.0, -1.0}) {
      Corridor corridor(is_turned);
      corridor.build(0.45 * side, 0.55 * side);
      EXPECT_NEAR(corridor.spot_m(), -side, 1e-9);
      corridor.build(-1.6 * side, -1.7 * side);  // behind the spot
      EXPECT_NEAR(corridor.spot_m(), -side, 1e-9);
      corridor.build(-0.45 * side, -0.55 * side);
      EXPECT_EQ(corridor.spot_m(), 0.0);
    }
  }
}

// The edge of the vehicle at its landing spot is at least 0.05 m from an obstacle.
TEST(LandingSpot, KeepsTheStatedDistanceFromObstacles) {
  for (const double side : {1.0, -1.0}) {
    const double end_m = test::last_accepted(3.0, 0.5, 1e-9, [&](double wall_m) {
      Corridor corridor;
      corridor.build(-0.45 * side, -0.55 * side);
      corridor.build(wall_m * side, (wall_m + 0.1) * side);
      return corridor.spot_m() != 0.0;
    });
    EXPECT_NEAR(end_m, 1.0 + bench_limits().vehicle.radius_m + 0.05, 1e-8);
  }
}

// A hover closer than 0.05 m to an obstacle still moves away from it when a body is below.
TEST(LandingSpot, IsFoundWhenStartingNextToAnObstacle) {
  const double radius_m = bench_limits().vehicle.radius_m;
  for (const bool is_turned : {false, true}) {
    for (const double side : {1.0, -1.0}) {
      for (const double edge_m : {-0.02, 0.0, 0.02, 0.049, 0.051, 0.2}) {
        Corridor corridor(is_turned);
        corridor.build((radius_m + edge_m) * side, (radius_m + edge_m + 0.1) * side);
        EXPECT_NEAR(corridor.spot_m(), -side, 1e-9) << edge_m;
        corridor.build(-0.45 * side, -0.55 * side);
        EXPECT_EQ(corridor.spot_m(), 0.0) << "no path through an obstacle";
      }
      // The spot also keeps 0.05 m from a second obstacle.
      for (const double beyond_m : {0.04, 0.06}) {
        Corridor corridor(is_turned);
        corridor.build((radius_m + 0.02) * side, (radius_m + 0.1) * side);
        const double wall_m = 1.0 + radius_m + beyond_m;
        corridor.build(-wall_m * side, -(wall_m + 0.1) * side);
        EXPECT_NEAR(corridor.spot_m(), beyond_m < 0.05 ? 0.0 : -side, 1e-9);
      }
    }
  }
}

// The path to the landing spot keeps a horizontal distance of landing_clearance_m + 0.1 m from
// robots and of separation_hold_m from other bodies.
TEST(LandingSpot, PathKeepsTheStatedDistanceFromBodies) {
  const auto passes_m = [](int robot, double above_m) {
    return test::last_accepted(3.0, 0.1, 1e-9, [&](double beside_m) {
      Corridor corridor;
      OtherBody body;
      body.has_priority = false;
      body.robot = robot;
      corridor.add(body, 0.5, beside_m, above_m);
      corridor.add(body, -0.5, beside_m, above_m);
      return corridor.spot_m() != 0.0;
    });
  };
  const SafetyLimits limits = bench_limits();
  EXPECT_NEAR(passes_m(-1, 0.0), limits.separation_hold_m, 1e-7);
  for (const int robot : {0, 1}) {
    for (const double above_m : {0.0, 0.5, 1.5}) {
      EXPECT_NEAR(passes_m(robot, above_m), limits.landing_clearance_m + 0.1, 1e-7) << robot;
    }
  }
}

// The landing spot keeps the landing clearance plus 0.1 m from a body below. A spot 1 m away
// therefore allows a clearance of at most 0.9 m.
TEST(LandingSpot, KeepsTheStatedDistanceFromBodiesBelow) {
  Corridor corridor;
  const double asked_m = test::last_accepted(0.8, 1.1, 1e-9, [&](double clearance_m) {
    corridor.ask_clearance(clearance_m);
    return std::abs(corridor.spot_m()) < 1.1;
  });
  EXPECT_NEAR(asked_m, 0.9, 1e-8);
}

// A body exactly separation_hold_m from the path does not block it, in any direction. Neither does
// a closer body at the side of the start, because its distance only increases. Rounding must not
// change either result.
TEST(IsPathBlocked, IgnoresDistantBodiesAndBodiesAtTheSide) {
  const SafetyLimits limits = bench_limits();
  test::Random random(54);
  for (int i = 0; i < 500; ++i) {
    const double heading_rad = random.uniform(-kPi, kPi);
    const Eigen::Vector3d ahead(std::cos(heading_rad), std::sin(heading_rad), 0.0);
    const Eigen::Vector3d aside(-ahead.y(), ahead.x(), 0.0);
    const Eigen::Vector3d from_m = random.vector<3>(-3.0, 3.0);
    OtherBody body;
    body.robot = random.integer(-1, 2);
    body.position_world_m = from_m + random.uniform(0.0, 1.0) * ahead +
                            (random.coin() ? 1.0 : -1.0) * limits.separation_hold_m * aside;
    EXPECT_FALSE(is_path_blocked(from_m, from_m + ahead, {&body, 1}, limits));
    body.position_world_m = from_m + random.uniform(0.05, 0.5) * aside;
    EXPECT_FALSE(is_path_blocked(from_m, from_m + ahead, {&body, 1}, limits));
  }
}

// All robots, including the one with index 0, count at any height. Other bodies count if they reach
// the height of the path or more.
TEST(IsPathBlocked, CountsRobotsAtAnyHeightAndOtherBodiesUnlessBelow) {
  const SafetyLimits limits = bench_limits();
  const Eigen::Vector3d from_m(1.0, -1.0, 1.0);
  const auto is_taken = [&](int robot, double above_m) {
    OtherBody body;
    body.position_world_m = from_m + Eigen::Vector3d(1.0, 0.1, above_m);
    body.robot = robot;
    return is_path_blocked(from_m, from_m + Eigen::Vector3d(2.0, 0.0, 0.0), {&body, 1}, limits);
  };
  for (const double above_m : {-0.9, 0.9}) {
    EXPECT_EQ(is_taken(-1, above_m), above_m > 0.0);
    EXPECT_TRUE(is_taken(0, above_m));
    EXPECT_TRUE(is_taken(1, above_m));
  }
  EXPECT_TRUE(is_taken(-1, 0.1));
  EXPECT_TRUE(is_taken(-1, -0.29));
}

// Robots at constant velocity block a climb if they come close within two seconds.
TEST(IsClimbBlocked, CountsRobotsWithinTwoSeconds) {
  const SafetyLimits limits = bench_limits();
  for (const double speed_mps : {0.0, 0.4, 1.0}) {
    const double from_m = test::last_accepted(5.0, 0.0, 1e-9, [&](double x_m) {
      OtherBody body;
      body.position_world_m = {1.0 - x_m, -1.0, 1.0};
      body.velocity_world_mps = {speed_mps, 0.0, 0.0};
      body.robot = 0;
      return !is_climb_blocked({1.0, -1.0, 0.3}, 1.5, {&body, 1}, limits);
    });
    EXPECT_NEAR(from_m, limits.separation_hold_m + 0.25 + 2.0 * speed_mps, 1e-8);
  }
}

/// Returns the distance, m, by which clear_spot() moves a hover with its edge `edge_m` from the
/// wall at y = −2; 0 if it finds no spot.
double moves_m(double edge_m, std::span<const OtherBody> others) {
  const SafetyLimits limits = limits_in({{-8.0, -2.0}, {12.0, 12.0}});
  const Eigen::Vector3d hover_m(3.0, -2.0 + limits.vehicle.radius_m + edge_m, 1.0);
  const auto spot_m = clear_spot(hover_m, others, limits);
  return spot_m ? (*spot_m - hover_m).norm() : 0.0;
}

// The hover moves straight away from the wall in steps of 5 cm, by at most 0.6 m, until its edge is
// 0.15 m away.
TEST(ClearSpot, IsTheNearestClearPosition) {
  ASSERT_EQ(bench_limits().hover_clearance_m, 0.1);
  EXPECT_EQ(moves_m(0.1001, {}), 0.0);
  for (double edge_m = 0.0999; edge_m > -0.55; edge_m -= 0.01) {
    const double steps = std::ceil((0.15 - edge_m) / 0.05);
    EXPECT_NEAR(moves_m(edge_m, {}), steps <= 12.0 ? 0.05 * steps : 0.0, 1e-9) << edge_m;
  }
}

// The spot keeps separation_hold_m + 0.05 m from another body ahead. A body that the hover moves
// away from has no effect.
TEST(ClearSpot, KeepsTheStatedDistanceFromBodies) {
  constexpr double kEdgeM = 0.0501;  // m; only the spot 0.1 m from the hover is clear
  const SafetyLimits limits = bench_limits();
  OtherBody body;
  const auto with_body_m = [&](double x_m, double y_m) {
    body.position_world_m = {3.0 + x_m, -2.0 + limits.vehicle.radius_m + kEdgeM + y_m, 1.0};
    return moves_m(kEdgeM, {&body, 1});
  };
  const double before_m = test::last_accepted(
      2.0, 0.3, 1e-9, [&](double y_m) { return std::abs(with_body_m(0.0, y_m) - 0.1) < 1e-9; });
  EXPECT_NEAR(before_m - 0.1, limits.separation_hold_m + 0.05, 1e-8);
  for (const double behind_m : {0.1, 0.4, 0.7, 2.0}) {
    EXPECT_NEAR(with_body_m(0.0, -behind_m), 0.1, 1e-9);
    EXPECT_NEAR(with_body_m(behind_m, -0.1), 0.1, 1e-9);
  }
}

}  // namespace
}  // namespace vantage::drivers
