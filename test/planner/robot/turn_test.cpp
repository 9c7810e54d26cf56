// Tests of the direction in which a robot turns when no motion is feasible from its hover pose.

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "planner/robot/trajectory_tools.hpp"
#include "planner/robot/turn_to_free_heading.hpp"

namespace vantage::planner {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A robot of radius 0.35 m in a square of 20 m.
class EscapeTurn : public ::testing::Test {
 protected:
  EscapeTurn() {
    world_.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
    problem_.start_time = kStart;
    problem_.height_m = 1.5;
    problem_.controls = models::lab_primitives();
    problem_.world = &world_;
    problem_.clearance_m = 0.35;
    problem_.separation_m = 1.0;
    problem_.brake_mps2 = 2.0;
  }

  /// Returns the direction of the turn: left (1), right (−1) or none (0).
  int side_of(const Pose2& start, bool is_blocked = false, double yaw_rate_max_radps = 3.0) {
    problem_.start = start;
    const auto turning = turn_to_free_heading(problem_, is_blocked, yaw_rate_max_radps);
    if (!turning) {
      return 0;
    }
    EXPECT_EQ(turning->start, start);
    EXPECT_EQ(turning->start_time, kStart);
    EXPECT_EQ(turning->height_m, 1.5);
    EXPECT_EQ(turning->segments.size(), 1U);
    const models::PlanSegment& segment = turning->segments.front();
    EXPECT_EQ(segment.control.speed_mps, 0.0);
    EXPECT_EQ(segment.brake_mps2, 0.0);
    const double rate_radps = std::min(1.5, yaw_rate_max_radps);
    EXPECT_EQ(std::abs(segment.control.yaw_rate_radps), rate_radps);
    EXPECT_NEAR(rate_radps * segment.duration_s, 0.25 * kPi, 1e-12) << "an eighth of a turn";
    return segment.control.yaw_rate_radps > 0.0 ? 1 : -1;
  }

  models::World world_;
  SearchProblem problem_;
};

// The robot turns away from the nearest teammate, at its position when the plan begins. It turns
// right if the opposite direction is more than π/4 to the right, else left.
TEST_F(EscapeTurn, TurnsAwayFromTooNearTeammate) {
  std::mt19937_64 rng(71);
  std::uniform_real_distribution<double> any(-kPi, kPi);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  for (int i = 0; i < 200; ++i) {
    const Pose2 start{place(rng), place(rng), any(rng)};
    const double off_rad = any(rng);  // rad; direction away from the teammate, from straight ahead
    const auto at = [&](double bearing_rad, double distance_m) {
      return Eigen::Vector2d(start.x_m + distance_m * std::cos(bearing_rad),
                             start.y_m + distance_m * std::sin(bearing_rad));
    };
    const Eigen::Vector2d near_m = at(start.yaw_rad + off_rad + kPi, 0.5);
    const Eigen::Vector2d less_near_m = at(any(rng), 0.8);
    // The teammate has approached at 1 m/s for two seconds.
    const double came_rad = any(rng);
    const Eigen::Vector2d from_m =
        near_m - 2.0 * Eigen::Vector2d(std::cos(came_rad), std::sin(came_rad));
    models::Trajectory near =
        hover_at({from_m.x(), from_m.y(), came_rad}, 1.5, kStart - from_seconds(2.0));
    near.segments = {{{1.0, 0.0}, 5.0, 0.0}};
    problem_.teammates = {hover_at({less_near_m.x(), less_near_m.y(), 0.0}, 1.5, kStart), near};
    if (std::abs(off_rad + 0.25 * kPi) < 1e-3) {
      continue;
    }
    EXPECT_EQ(side_of(start, i % 2 == 0), off_rad < -0.25 * kPi ? -1 : 1) << off_rad;
  }
  problem_.teammates = {hover_at({-0.5, 0.0, 0.0}, 1.5, kStart)};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), 1) << "straight behind: turns continuously";
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}, false, 0.5), 1) << "at the maximum rate";
}

// In free space the robot keeps its heading. If the search found no plan, the robot turns left.
TEST_F(EscapeTurn, KeepsItsHeadingInFreeSpace) {
  for (int i = 0; i < 8; ++i) {
    const Pose2 start{0.0, 0.0, wrap_to_pi(0.25 * kPi * i)};
    EXPECT_EQ(side_of(start), 0);
    EXPECT_EQ(side_of(start, true), 1);
  }
}

// In a corner, five centimetres from the clearance limit, only west and south are feasible.
TEST_F(EscapeTurn, TurnsToTheNearestFreeHeading) {
  const auto in_the_corner = [&](double heading_deg) {
    return side_of({9.6, 9.6, radians(heading_deg)});
  };
  EXPECT_EQ(in_the_corner(180.0), 0);
  EXPECT_EQ(in_the_corner(-90.0), 0);
  EXPECT_EQ(in_the_corner(-135.0), 0);
  EXPECT_EQ(in_the_corner(135.0), 1) << "west, an eighth to the left";
  EXPECT_EQ(in_the_corner(-45.0), -1) << "south, an eighth to the right";
  EXPECT_EQ(in_the_corner(90.0), 1);
  EXPECT_EQ(in_the_corner(0.0), -1);
  EXPECT_EQ(in_the_corner(45.0), 1) << "equally far in both directions";
  // In the opposite corner, east and north are feasible.
  EXPECT_EQ(side_of({-9.6, -9.6, radians(180.0)}), -1);
  EXPECT_EQ(side_of({-9.6, -9.6, radians(-90.0)}), 1);
}

// At the closed end of a lane only the reverse heading is feasible; between four walls no heading
// is feasible.
TEST_F(EscapeTurn, ReversesInADeadEnd) {
  world_.obstacles = {{{{0.0, 0.4}, {3.0, 1.0}}, 2.0},
                      {{{0.0, -1.0}, {3.0, -0.4}}, 2.0},
                      {{{2.4, -0.4}, {3.0, 0.4}}, 2.0}};
  EXPECT_EQ(side_of({2.0, 0.0, 0.0}), 1);
  EXPECT_EQ(side_of({2.0, 0.0, kPi}), 0);
  EXPECT_EQ(side_of({1.6, 0.0, 0.0}), 1) << "enough space for a stop, but not for a step";
  world_.obstacles.push_back({{{1.0, -0.4}, {1.6, 0.4}}, 2.0});
  for (const double yaw_rad : {0.0, 0.5 * kPi, kPi, -0.5 * kPi}) {
    EXPECT_EQ(side_of({2.0, 0.0, yaw_rad}), 0);
    EXPECT_EQ(side_of({2.0, 0.0, yaw_rad}, true), 1);
  }
}

// A teammate that hovers two centimetres beyond the required separation blocks a heading like a
// wall.
TEST_F(EscapeTurn, TreatsTeammatesLikeWalls) {
  const models::Trajectory ahead = hover_at({1.02, 0.0, 0.0}, 1.5, kStart);
  const models::Trajectory left = hover_at({0.0, 1.02, 0.0}, 1.5, kStart);
  const models::Trajectory right = hover_at({0.0, -1.02, 0.0}, 1.5, kStart);
  problem_.teammates = {ahead};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), 1);
  EXPECT_EQ(side_of({0.0, 0.0, kPi}), 0);
  problem_.teammates = {ahead, left};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), -1);
  problem_.teammates = {right, ahead};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), 1);
  problem_.teammates = {left};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), 0) << "next to the teammate";
}

// Controls that turn on the spot do not count as motions.
TEST_F(EscapeTurn, IgnoresControlsThatOnlyTurn) {
  problem_.controls = {{0.0, 1.0}, {0.0, 0.0}};
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}), 0) << "every heading is blocked";
  EXPECT_EQ(side_of({0.0, 0.0, 0.0}, true), 1);
  problem_.controls.push_back({1.0, 0.0});
  EXPECT_EQ(side_of({9.6, 0.0, 0.0}), 1);
}

}  // namespace
}  // namespace vantage::planner
