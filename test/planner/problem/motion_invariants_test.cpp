// Tests of the invariances of a motion table, and of limits with a closed form.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/plan/plan.hpp"
#include "planner/problem/motion_table.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/bisect.hpp"

namespace vantage::planner {
namespace {

using test::last_accepted;
using test::pick;
using test::uniform;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

// Returns a problem with a start so far from the teammates that the full separation is required.
SearchProblem crowded_problem(std::mt19937_64& rng) {
  SearchProblem problem;
  problem.start_time = kStart;
  problem.start.x_m = 100.0;
  problem.height_m = 1.2;
  problem.controls = models::standard_primitives();
  problem.horizon_steps = pick(rng, 3, 6);
  problem.step_s = 0.5;
  problem.separation_m = uniform(rng, 0.4, 1.2);
  problem.brake_mps2 = uniform(rng, 1.5, 4.0);
  for (int i = 0; i < 3; ++i) {
    problem.teammates.push_back(test::random_teammate(rng, kStart, pick(rng, 0, 8), 0.4));
    problem.teammates.back().height_m = uniform(rng, 0.8, 1.6);
  }
  return problem;
}

struct Answers {
  std::vector<bool> free;
  bool may_stop = false;
};

Answers ask(const MotionTable& motion, const Pose2& from, int depth) {
  Answers answers;
  for (int c = 0; c < motion.control_count(); ++c) {
    answers.free.push_back(
        motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), c, depth));
  }
  answers.may_stop = motion.can_stop(from, 0, depth);
  return answers;
}

// Calls look(problem, from, depth, answers) for many problems.
template <class Look>
void for_crowded_problems(const Look& look) {
  std::mt19937_64 rng(61);
  MotionTable motion(64, 16, 4);
  int free = 0;
  int taken = 0;
  int stops = 0;
  int moves_on = 0;
  for (int i = 0; i < 40; ++i) {
    const SearchProblem problem = crowded_problem(rng);
    motion.reset(problem);
    for (int k = 0; k < 15; ++k) {
      const Pose2 from{uniform(rng, -4.0, 4.0), uniform(rng, -4.0, 4.0), uniform(rng, -kPi, kPi)};
      const int depth = pick(rng, 0, problem.horizon_steps - 1);
      const Answers answers = ask(motion, from, depth);
      const auto count = std::count(answers.free.begin(), answers.free.end(), true);
      free += static_cast<int>(count);
      taken += motion.control_count() - static_cast<int>(count);
      (answers.may_stop ? stops : moves_on) += 1;
      look(problem, from, depth, answers);
    }
  }
  EXPECT_GT(free, 500);
  EXPECT_GT(taken, 500);
  EXPECT_GT(stops, 100);
  EXPECT_GT(moves_on, 50);
}

// A motion is free with all teammates if and only if it is free with each single teammate, in any
// order.
TEST(MotionTable, IsFreeOfTheTeamIfFreeOfEachTeammate) {
  for_crowded_problems(
      [](const SearchProblem& problem, const Pose2& from, int depth, const Answers& answers) {
        std::vector<bool> free(answers.free.size(), true);
        bool may_stop = true;
        for (const models::Trajectory& teammate : problem.teammates) {
          SearchProblem beside_one = problem;
          beside_one.teammates = {teammate};
          MotionTable motion(64, 16, 4);
          motion.reset(beside_one);
          const Answers of_one = ask(motion, from, depth);
          for (std::size_t c = 0; c < free.size(); ++c) {
            free[c] = free[c] && of_one.free[c];
          }
          may_stop = may_stop && of_one.may_stop;
        }
        EXPECT_EQ(answers.free, free);
        EXPECT_EQ(answers.may_stop, may_stop);
      });
}

// A later step has the same answers as the first step of a plan that starts later.
TEST(MotionTable, LaterStepEqualsFirstStepOfALaterPlan) {
  for_crowded_problems(
      [](const SearchProblem& problem, const Pose2& from, int depth, const Answers& answers) {
        SearchProblem later = problem;
        later.start_time += from_seconds(depth * problem.step_s);
        MotionTable motion(64, 16, 4);
        motion.reset(later);
        const Answers then = ask(motion, from, 0);
        EXPECT_EQ(answers.free, then.free) << depth;
        EXPECT_EQ(answers.may_stop, then.may_stop) << depth;
      });
}

// A mirrored problem has the same answers; rounding does not affect these cases.
TEST(MotionTable, IsMirrorSymmetric) {
  for_crowded_problems(
      [](const SearchProblem& problem, const Pose2& from, int depth, const Answers& answers) {
        SearchProblem mirrored = problem;
        for (models::UnicycleControl& control : mirrored.controls) {
          control.yaw_rate_radps = -control.yaw_rate_radps;
        }
        for (models::Trajectory& teammate : mirrored.teammates) {
          teammate.start = {teammate.start.x_m, -teammate.start.y_m, -teammate.start.yaw_rad};
          for (models::PlanSegment& segment : teammate.segments) {
            segment.control.yaw_rate_radps = -segment.control.yaw_rate_radps;
          }
        }
        MotionTable motion(64, 16, 4);
        motion.reset(mirrored);
        const Answers turned = ask(motion, {from.x_m, -from.y_m, -from.yaw_rad}, depth);
        EXPECT_EQ(answers.free, turned.free);
        EXPECT_EQ(answers.may_stop, turned.may_stop);
      });
}

// Compares the answers with sampled distances. A robot that may stop keeps the separation from
// teammates that move during and after the stop. A refused stop exceeds the limit by no more than
// the error of the chords.
TEST(CanStop, KeepsSeparationFromMovingTeammates) {
  for_crowded_problems([](const SearchProblem& problem, const Pose2& from, int depth,
                          const Answers& answers) {
    models::Trajectory own;
    own.start_time = problem.start_time + from_seconds(depth * problem.step_s);
    own.start = from;
    own.segments = models::brake(problem.controls[0].speed_mps, problem.brake_mps2);
    double least_m = std::numeric_limits<double>::infinity();
    for (const models::Trajectory& teammate : problem.teammates) {
      const Time last = std::max(models::end_time(own), models::end_time(teammate));
      for (Time t = own.start_time; t < last + from_seconds(0.02); t += from_seconds(0.01)) {
        const Eigen::Vector2d offset_m = models::at(own, t).world_from_body.position_m() -
                                         models::at(teammate, t).world_from_body.position_m();
        least_m =
            std::min(least_m, std::hypot(offset_m.norm(), teammate.height_m - problem.height_m));
      }
    }
    // The allowance is twice the chord error: 11 mm for arcs at 3 m/s and 3 rad/s, 75 mm for a
    // speed jump of 3 m/s, 5 mm for braking. Sampling adds 6 m/s for half of 10 ms.
    if (answers.may_stop) {
      EXPECT_GE(least_m, problem.separation_m);
    } else {
      EXPECT_LE(least_m, problem.separation_m + 0.22);
    }
  });
}

TEST(CanStop, UsesTheStartSpeedAtTheStart) {
  std::mt19937_64 rng(62);
  models::World world;
  world.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  int stops = 0;
  for (int i = 0; i < 60; ++i) {
    SearchProblem problem = crowded_problem(rng);
    problem.world = &world;
    problem.clearance_m = 0.3;
    problem.start = {uniform(rng, -9.0, 9.0), uniform(rng, -9.0, 9.0), uniform(rng, -kPi, kPi)};
    problem.teammates.resize(1);
    problem.start_speed_mps = 2.0;
    problem.controls = {{1.0, 0.0}, {2.0, 3.0}};
    MotionTable motion(64, 16, 4);
    motion.reset(problem);
    EXPECT_EQ(motion.can_stop_from_start(), motion.can_stop(problem.start, 1, 0)) << i;
    stops += motion.can_stop_from_start() ? 1 : 0;
    problem.brake_mps2 = 0.0;  // no stop is required
    motion.reset(problem);
    EXPECT_TRUE(motion.can_stop_from_start());
    EXPECT_TRUE(motion.can_stop({9.8, 0.0, 0.0}, 1, 0));
  }
  EXPECT_GT(stops, 20);
  EXPECT_LT(stops, 60);
}

// After a stop of length v²/2a, the robot's disc is just clear of the wall ahead.
TEST(CanStop, NeedsFullStoppingDistance) {
  models::World world;
  world.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  for (const double yaw_rad : {0.0, 0.5 * kPi, kPi, -0.5 * kPi}) {
    for (const double speed_mps : {0.5, 2.0}) {
      SearchProblem problem;
      problem.controls = {{1.0, 1.0}, {speed_mps, 0.0}};
      problem.world = &world;
      problem.clearance_m = 0.3;
      problem.brake_mps2 = 1.6;
      MotionTable motion(64, 16, 4);
      motion.reset(problem);
      const double last_m = last_accepted(0.0, 9.9, 1e-6, [&](double at_m) {
        return motion.can_stop({at_m * std::cos(yaw_rad), at_m * std::sin(yaw_rad), yaw_rad}, 1, 2);
      });
      EXPECT_NEAR(last_m, 10.0 - 0.3 - speed_mps * speed_mps / 3.2, 1e-5) << yaw_rad;
    }
  }
}

// Returns the greatest separation that is accepted for a robot hovering ahead, in the step that
// begins `depth` steps later. The teammate approaches along the x axis; a step of 0.5 s has five
// pieces.
double greatest_separation_m(const std::vector<models::PlanSegment>& segments, int depth,
                             double started_s = 0.0, double x_m = 20.0, double y_m = 0.0) {
  SearchProblem problem;
  problem.start_time = kStart;
  problem.start.x_m = 100.0;
  problem.horizon_steps = 4;
  problem.controls = {{0.0, 0.0}};
  models::Trajectory teammate;
  teammate.start_time = kStart - from_seconds(started_s);
  teammate.segments = segments;
  problem.teammates = {teammate};
  MotionTable motion(64, 16, 4);
  return last_accepted(0.0, 60.0, 1e-7, [&](double separation_m) {
    problem.separation_m = separation_m;
    motion.reset(problem);
    return motion.is_free({x_m, y_m, 0.0}, 1.0, 0.0, 0, depth);
  });
}

// Each piece is treated as straight and uniform. If it is straight and uniform, only the rounding
// of the clock is added. Otherwise the allowance is exactly a Δ²/8 for an acceleration a, and J s
// (1 − s) Δ for a speed jump J after the share s of the piece.
TEST(IsFree, AllowsOnlyForTheCurvatureOfATeammatesPiece) {
  constexpr double kPiece_s = 0.1;
  constexpr double kClock_m = 1e-5;
  const auto bulge_m = [&](double acceleration_mps2) {
    return acceleration_mps2 * kPiece_s * kPiece_s / 8.0;
  };
  const auto kink_m = [&](double jump_mps, double share) {
    return jump_mps * share * (1.0 - share) * kPiece_s;
  };
  struct Case {
    std::string what;
    std::vector<models::PlanSegment> segments;
    double started_s = 0.0;
    int depth = 0;
    double x_m = 20.0;
    double expected_m = 0.0;
  };
  // Returns the distance driven in `s` seconds at 1 m/s while braking at 2 m/s².
  const auto slowed_m = [](double s) { return s - s * s; };
  const std::vector<Case> cases = {
      {"at rest", {}, 0.0, 1, 20.0, 20.0},
      {"evenly", {{{1.0, 0.0}, 9.0, 0.0}}, 0.0, 0, 20.0, 19.5},
      {"evenly, in its second step", {{{1.0, 0.0}, 9.0, 0.0}}, 0.0, 1, 20.0, 19.0},
      {"evenly, for a while already", {{{1.0, 0.0}, 9.0, 0.0}}, 2.0, 1, 20.0, 17.0},
      {"backwards", {{{-2.0, 0.0}, 9.0, 0.0}}, 0.0, 1, -20.0, 18.0},
      {"the same speed in two segments",
       {{{1.0, 0.0}, 0.25, 0.0}, {{1.0, 0.0}, 9.0, 0.0}},
       0.0,
       0,
       20.0,
       19.5},
      {"faster, in the middle of its last piece",
       {{{1.0, 0.0}, 0.45, 0.0}, {{3.0, 0.0}, 9.0, 0.0}},
       0.0,
       0,
       20.0,
       20.0 - 0.6 - kink_m(2.0, 0.5)},
      {"slower, a fifth into its last piece",
       {{{3.0, 0.0}, 0.42, 0.0}, {{1.0, 0.0}, 9.0, 0.0}},
       0.0,
       0,
       20.0,
       20.0 - 1.34 - kink_m(2.0, 0.2)},
      {"there and back, in the middle of its last piece",
       {{{2.0, 0.0}, 1.45, 0.0}, {{-2.0, 0.0}, 9.0, 0.0}},
       0.0,
       2,
       20.0,
       20.0 - 2.8 - kink_m(4.0, 0.5)},
      {"until it hovers, a fifth before its last piece ends",
       {{{2.0, 0.0}, 0.98, 0.0}},
       0.0,
       1,
       20.0,
       20.0 - 1.96 - kink_m(2.0, 0.8)},
      {"from rest, in the middle of its last piece",
       {{{2.0, 0.0}, 9.0, 0.0}},
       -0.45,
       0,
       20.0,
       20.0 - 0.1 - kink_m(2.0, 0.5)},
      {"after a segment of no time, and one of less",
       {{{5.0, 0.0}, 0.0, 0.0}, {{5.0, 0.0}, -3.0, 0.0}, {{1.0, 0.0}, 9.0, 0.0}},
       0.0,
       1,
       20.0,
       19.0},
      {"braking all along",
       {{{1.0, 0.0}, 0.5, 2.0}},
       0.0,
       0,
       20.0,
       20.0 - slowed_m(0.5) - bulge_m(2.0)},
      {"braking backwards",
       {{{-1.0, 0.0}, 0.5, 2.0}},
       0.0,
       0,
       -20.0,
       20.0 - slowed_m(0.5) - bulge_m(2.0)},
      {"braking, and cut off before it stands",
       {{{1.0, 0.0}, 0.25, 2.0}, {{0.5, 0.0}, 9.0, 0.0}},
       0.0,
       0,
       20.0,
       20.0 - slowed_m(0.25) - 0.125},
      {"braking, and let off in the middle of its last piece",
       {{{1.0, 0.0}, 0.45, 2.0}, {{1.0, 0.0}, 9.0, 0.0}},
       0.0,
       0,
       20.0,
       20.0 - slowed_m(0.45) - 0.05 - bulge_m(2.0) - kink_m(0.9, 0.5)},
      {"braking for longer than it takes to stand",
       {{{1.0, 0.0}, 2.0, 2.0}},
       0.0,
       2,
       20.0,
       20.0 - 0.25 - bulge_m(2.0)},
  };
  for (const Case& each : cases) {
    for (const double side : {1.0, -1.0}) {  // forwards and in reverse
      std::vector<models::PlanSegment> segments = each.segments;
      for (models::PlanSegment& segment : segments) {
        segment.control.speed_mps *= side;
      }
      EXPECT_NEAR(greatest_separation_m(segments, each.depth, each.started_s, side * each.x_m),
                  each.expected_m - kClock_m, 3e-6)
          << each.what << ' ' << side;
    }
  }
  // The teammate drives around a circle of radius 1 m about (0, ±1) at 2 rad/s, 0.2 rad per piece.
  // The second piece is 0.2 to 0.4 rad past the nearest point to the x axis. The hover is far
  // outside, opposite the middle of that piece's chord.
  for (const double side : {1.0, -1.0}) {
    const double chord_m = std::cos(0.1);  // m; distance of the chord from the centre
    const Eigen::Vector2d out(std::sin(0.3), -std::cos(0.3));
    const Eigen::Vector2d there(20.0 * out.x(), side * (1.0 + 20.0 * out.y()));
    EXPECT_NEAR(
        greatest_separation_m({{{2.0, side * 2.0}, 9.0, 0.0}}, 0, 0.0, there.x(), there.y()),
        20.0 - chord_m - bulge_m(4.0) - kClock_m, 3e-6)
        << side;
  }
}

// A robot and a teammate drive towards each other. The greatest accepted separation is their
// distance at the end of the step. A distant teammate that is listed first has no effect.
TEST(IsFree, ChecksTheEndOfAStep) {
  for (const double side : {1.0, -1.0}) {
    for (const int depth : {0, 1, 3}) {
      SearchProblem problem;
      problem.start_time = kStart;
      problem.start.x_m = 100.0;
      problem.horizon_steps = 4;
      problem.controls = {{0.5, 0.0}, {3.0, 0.0}};
      models::Trajectory far;
      far.start = {50.0, 50.0, 0.0};
      models::Trajectory teammate;
      teammate.start_time = kStart;
      teammate.start.yaw_rad = side > 0.0 ? 0.0 : kPi;
      teammate.segments = {{{2.0, 0.0}, 9.0, 0.0}};
      problem.teammates = {far, teammate};
      MotionTable motion(64, 16, 4);
      const double let_m = last_accepted(0.0, 20.0, 1e-7, [&](double separation_m) {
        problem.separation_m = separation_m;
        motion.reset(problem);
        return motion.is_free({side * 20.0, 0.0, 0.0}, -side, 0.0, 1, depth);
      });
      EXPECT_NEAR(let_m, 20.0 - 1.0 * (depth + 1) - 1.5, 2e-5) << side << ' ' << depth;
    }
  }
}

// For an arc of the robot, to either side, the allowance is exactly the sagitta ν ω Δ²/8.
TEST(IsFree, AddsExactlyTheSagittaOfTheRobotsArc) {
  for (const double side : {1.0, -1.0}) {
    SearchProblem problem;
    problem.start_time = kStart;
    problem.start.x_m = 100.0;
    problem.horizon_steps = 2;
    problem.controls = {{2.0, side * 2.0}};
    models::Trajectory hover;
    hover.start_time = kStart;
    // The hover is far outside the arc, opposite the middle of the second piece's chord.
    hover.start = {20.0 * std::sin(0.3), side * (1.0 - 20.0 * std::cos(0.3)), 0.0};
    problem.teammates = {hover};
    MotionTable motion(64, 16, 4);
    const double let_m = last_accepted(0.0, 20.0, 1e-7, [&](double separation_m) {
      problem.separation_m = separation_m;
      motion.reset(problem);
      return motion.is_free({}, 1.0, 0.0, 0, 1);
    });
    EXPECT_NEAR(let_m, 20.0 - std::cos(0.1) - 4.0 * 0.01 / 8.0 - 1e-5, 3e-6) << side;
  }
}

// Headings stay within (−π, π], bit for bit as from wrap_to_pi().
TEST(MotionTable, WrapsHeadingsLikeTheUnicycleModel) {
  std::mt19937_64 rng(63);
  SearchProblem problem;
  for (const double turn_rad : {0.0, 0.5 * kPi, -0.5 * kPi, kPi, -kPi, 1.0, -3.0}) {
    problem.controls.push_back({1.0, turn_rad / 0.5});
  }
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  std::vector<double> yaws_rad = {
      0.0, kPi, std::nextafter(kPi, 0.0), -std::nextafter(kPi, 0.0), 0.5 * kPi, -0.5 * kPi};
  for (int i = 0; i < 200; ++i) {
    yaws_rad.push_back(uniform(rng, -kPi, kPi));
  }
  for (const double yaw_rad : yaws_rad) {
    for (int c = 0; c < motion.control_count(); ++c) {
      const models::UnicycleControl& control = problem.controls[static_cast<std::size_t>(c)];
      const double turned_rad = models::step_unicycle({}, control, problem.step_s).yaw_rad;
      const Pose2 from{1.0, 2.0, yaw_rad};
      const double expected_rad = wrap_to_pi(yaw_rad + turned_rad);
      EXPECT_EQ(motion.child_yaw_rad(from, c), expected_rad) << yaw_rad << ' ' << c;
      EXPECT_EQ(motion.child(from, std::cos(yaw_rad), std::sin(yaw_rad), c).yaw_rad, expected_rad);
    }
  }
}

// The reach is the length of the longest step of any control of the current problem.
TEST(MotionTable, ReachEqualsTheFastestControl) {
  models::World world;
  world.bounds = {{-10.0, -10.0}, {10.0, 10.0}};
  const models::DistanceField field(world, 0.1);
  SearchProblem problem;
  problem.step_s = 0.4;
  problem.controls = {{1.0, 0.0}, {3.0, 2.0}, {2.0, 0.0}};
  problem.clearance_m = 0.5;
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  EXPECT_EQ(motion.control_count(), 3);
  EXPECT_NEAR(motion.reach_m(), 1.2, 1e-12);
  EXPECT_TRUE(motion.is_open_space({99.0, 0.0})) << "without a world";
  problem.world = &world;
  motion.reset(problem);
  EXPECT_FALSE(motion.is_open_space({0.0, 0.0})) << "unknown without a distance field";
  problem.field = &field;
  for (const double speed_mps : {3.0, 1.0}) {
    problem.controls = {{0.5, 0.0}, {speed_mps, 0.0}};
    motion.reset(problem);
    EXPECT_EQ(motion.control_count(), 2);
    EXPECT_NEAR(motion.reach_m(), 0.4 * speed_mps, 1e-12);
    const double last_m = last_accepted(0.0, 9.9, 1e-6, [&](double x_m) {
      return motion.is_open_space({x_m, 0.05});
    });
    // The distance field is a lower bound and too low by at most a cell diagonal.
    EXPECT_LE(last_m, 10.0 - 0.5 - 0.4 * speed_mps);
    EXPECT_GE(last_m, 10.0 - 0.5 - 0.4 * speed_mps - 0.15);
  }
}

// Plans of teammates may continue for three horizons.
TEST(MotionTable, AllocatesNothingWithinItsCapacity) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  SearchProblem problem;
  problem.horizon_steps = 4;
  problem.controls = models::standard_primitives();
  models::Trajectory teammate;
  teammate.segments = {{{1.0, 0.0}, 11 * problem.step_s, 0.0}};
  problem.teammates.assign(3, teammate);
  MotionTable motion(static_cast<int>(problem.controls.size()), 12, 3);
  const test::AllocationCounter allocations;
  motion.reset(problem);
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace vantage::planner
