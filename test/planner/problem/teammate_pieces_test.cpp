// Compares a motion table with the committed motion of teammates, piece by piece.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "models/plan/plan.hpp"
#include "planner/problem/motion_table.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/support/bisect.hpp"

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

// A teammate drives along the x axis at 1 m/s and passes a robot that hovers at the origin at 3 s.
TEST(IsFree, UsesTeammatePositionOfTheSameStep) {
  SearchProblem problem;
  problem.start_time = from_utime(1'700'000'000'000'000);
  problem.horizon_steps = 8;
  problem.step_s = 0.5;
  problem.controls = {{0.0, 0.0}};
  problem.separation_m = 0.45;
  models::Trajectory teammate;
  teammate.start_time = problem.start_time;
  teammate.start = {-3.0, 0.0, 0.0};
  teammate.segments = {{{1.0, 0.0}, 6.0, 0.0}};
  problem.teammates = {teammate};
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  for (int depth = 0; depth < problem.horizon_steps; ++depth) {
    const bool passes = depth == 5 || depth == 6;
    EXPECT_EQ(motion.is_free({}, 1.0, 0.0, 0, depth), !passes) << depth;
  }
}

// A teammate that turns a full circle within one step ends where it began, so its chord does not
// bound its distance.
TEST(IsFree, DetectsATeammateThatCirclesWithinOneStep) {
  SearchProblem problem;
  problem.horizon_steps = 2;
  problem.step_s = 1.0;
  problem.controls = {{0.0, 0.0}};
  problem.separation_m = 0.5;
  models::Trajectory teammate;
  const double diameter_m = 20.0;
  teammate.start = {-diameter_m, 0.0, -kPi / 2};
  teammate.segments.push_back({{kPi * diameter_m, 2.0 * kPi}, 1.0, 0.0});
  problem.teammates = {teammate};
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  EXPECT_FALSE(motion.is_free({}, 1.0, 0.0, 0, 0));
}

// Opposite turns of a teammate within one piece cancel, but its path still bulges beyond the chord.
TEST(IsFree, AccountsForTurnsWithinATeammatesPiece) {
  std::mt19937_64 rng(33);
  for (int i = 0; i < 400; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.horizon_steps = 2;
    problem.controls = {{0.0, 0.0}, {1.0, 0.0}};
    problem.start.x_m = 100.0;  // m; far from the teammate
    models::Trajectory teammate;
    teammate.start_time = problem.start_time;
    teammate.start = {-1.5, 0.0, 0.0};
    for (int k = 0; k < 12; ++k) {
      // Two of three turn in one direction only, left or right.
      const double sign = i % 3 == 1 ? 1.0 : i % 3 == 2 || k % 2 == 1 ? -1.0 : 1.0;
      teammate.segments.push_back(
          {{uniform(rng, 0.0, 6.0), sign * 10.0}, uniform(rng, 0.02, 0.1), 0.0});
    }
    problem.teammates = {teammate};
    const Pose2 from{uniform(rng, -1.5, 1.5), uniform(rng, -0.6, 0.6), uniform(rng, -kPi, kPi)};
    for (const int c : {0, 1}) {
      models::Trajectory own;
      own.start_time = problem.start_time;
      own.start = from;
      own.segments = {{problem.controls[static_cast<std::size_t>(c)], problem.step_s, 0.0}};
      double least_m = std::numeric_limits<double>::infinity();
      for (int ms = 0; ms <= 500; ++ms) {
        const Time t = problem.start_time + from_seconds(0.001 * ms);
        least_m = std::min(least_m, (models::at(own, t).world_from_body.position_m() -
                                     models::at(teammate, t).world_from_body.position_m())
                                        .norm());
      }
      // A required separation slightly above the actual one must be refused.
      problem.separation_m = least_m + 1e-4;
      MotionTable motion(64, 16, 4);
      motion.reset(problem);
      EXPECT_FALSE(motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), c, 0));
      if (least_m > 0.6) {  // the allowance is below 0.6 m
        problem.separation_m = least_m - 0.6;
        motion.reset(problem);
        EXPECT_TRUE(motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), c, 0));
      }
    }
  }
}

// A stop lasts longer than any teammate's motion and passes a hovering teammate. All instants of
// the stop must be checked.
TEST(CanStop, DetectsHoverNextToEndOfLongStop) {
  std::mt19937_64 rng(34);
  int stops = 0;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.horizon_steps = pick(rng, 1, 4);
    problem.controls = {{1.0, 0.0}, {0.5, 0.0}};
    problem.brake_mps2 = uniform(rng, 0.1, 1.0);  // the stop takes up to ten seconds
    problem.start.x_m = 100.0;                    // m; far from the teammate
    models::Trajectory hover;
    hover.start_time = problem.start_time;
    problem.teammates = {hover};
    for (const int c : {0, 1}) {
      const double speed_mps = problem.controls[static_cast<std::size_t>(c)].speed_mps;
      const double way_m = 0.5 * speed_mps * speed_mps / problem.brake_mps2;
      // The hover lies next to a point on the last third of the stopping distance.
      const double ahead_m = uniform(rng, 0.66, 1.2) * way_m;
      const double beside_m = uniform(rng, -0.5, 0.5);
      const double yaw_rad = uniform(rng, -kPi, kPi);
      const Eigen::Vector2d from_m =
          -(Eigen::Rotation2Dd(yaw_rad) * Eigen::Vector2d(ahead_m, beside_m));
      const Pose2 at{from_m.x(), from_m.y(), yaw_rad};
      const double least_m = std::hypot(std::max(0.0, ahead_m - way_m), beside_m);
      for (const double spare_m : {-1e-3, 0.02}) {
        problem.separation_m = least_m - spare_m;
        MotionTable motion(64, 16, 4);
        motion.reset(problem);
        const bool may_stop = motion.can_stop(at, c, problem.horizon_steps);
        EXPECT_EQ(may_stop, spare_m > 0.0) << i << " least " << least_m;
        (may_stop ? stops : refused) += 1;
      }
    }
  }
  EXPECT_GT(stops, 300);
  EXPECT_GT(refused, 300);
}

// The pieces of a stop are treated as uniform motion with an allowance of a Δ²/8. The greatest
// accepted separation is the distance that remains after a stop of v²/2a, minus this allowance.
TEST(CanStop, AddsExactlyTheBrakingAllowance) {
  for (const double brake_mps2 : {0.5, 2.0, 4.0}) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.start.x_m = 100.0;
    problem.horizon_steps = 4;
    problem.controls = {{1.0, 0.0}};
    problem.brake_mps2 = brake_mps2;
    models::Trajectory hover;
    hover.start_time = problem.start_time;
    hover.start.x_m = 20.0;
    problem.teammates = {hover};
    MotionTable motion(64, 16, 4);
    const double let_m = test::last_accepted(0.0, 20.0, 1e-7, [&](double separation_m) {
      problem.separation_m = separation_m;
      motion.reset(problem);
      return motion.can_stop({}, 0, 2);
    });
    constexpr double kClock_m = 1e-5;
    EXPECT_NEAR(let_m, 20.0 - 0.5 / brake_mps2 - brake_mps2 * 0.01 / 8.0 - kClock_m, 3e-6)
        << brake_mps2;
  }
}

// An arc bulges beyond its chords, left or right. An arc must be refused if the required separation
// is slightly above the actual one.
TEST(IsFree, AccountsForTheBulgeOfItsArc) {
  std::mt19937_64 rng(35);
  int accepted = 0;
  for (int i = 0; i < 2000; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.horizon_steps = 2;
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    problem.controls = {{uniform(rng, 0.5, 2.0), side * uniform(rng, 0.5, 4.0)}};
    problem.start.x_m = 100.0;
    // The hover is on the outer side of the middle of the arc, so that the bulge is nearest.
    const Pose2 from{uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -kPi, kPi)};
    const Pose2 middle =
        models::step_unicycle(from, problem.controls[0], uniform(rng, 0.1, 0.9) * problem.step_s);
    const double outwards_rad = middle.yaw_rad - side * 0.5 * kPi;
    const double apart_m = uniform(rng, 0.3, 0.8);
    models::Trajectory hover;
    hover.start_time = problem.start_time;
    hover.start = {middle.x_m + apart_m * std::cos(outwards_rad),
                   middle.y_m + apart_m * std::sin(outwards_rad), 0.0};
    problem.teammates = {hover};
    double least_m = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) {
      const Pose2 here =
          models::step_unicycle(from, problem.controls[0], problem.step_s * k / 2000.0);
      least_m = std::min(least_m, (here.position_m() - hover.start.position_m()).norm());
    }
    MotionTable motion(64, 16, 4);
    problem.separation_m = least_m + 1e-4;
    motion.reset(problem);
    EXPECT_FALSE(motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), 0, 0)) << i;
    problem.separation_m = least_m - 0.05;  // the allowance is usually below 0.05 m
    motion.reset(problem);
    accepted += motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), 0, 0) ? 1 : 0;
  }
  EXPECT_GT(accepted, 1900);
}

}  // namespace
}  // namespace vantage::planner
