#include "planner/problem/motion_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "models/plan/plan.hpp"
#include "planner/search/arvi.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

models::World random_world(std::mt19937_64& rng) {
  models::World world;
  world.bounds = {{-6.0, -6.0}, {6.0, 6.0}};
  for (int i = pick(rng, 1, 6); i > 0; --i) {
    const Eigen::Vector2d corner(uniform(rng, -6.0, 5.0), uniform(rng, -6.0, 5.0));
    // Sampling along a path would miss walls as thin as a centimetre.
    const Eigen::Vector2d size(uniform(rng, 0.01, 2.0), uniform(rng, 0.01, 2.0));
    world.obstacles.push_back({{corner, corner + size}, 10.0});
  }
  return world;
}

Pose2 random_pose(std::mt19937_64& rng) {
  return {uniform(rng, -6.2, 6.2), uniform(rng, -6.2, 6.2), uniform(rng, -kPi, kPi)};
}

double sampled_clearance_m(const models::World& world, const Pose2& from,
                           const models::UnicycleControl& control, double duration_s) {
  constexpr int kSamples = 250;
  double least_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSamples; ++i) {
    const Pose2 pose = models::step_unicycle(from, control, duration_s * i / kSamples);
    least_m = std::min(least_m, models::clearance_m(world, pose.position_m()));
  }
  return least_m;
}

TEST(MotionTable, EqualsTheUnicycleModel) {
  std::mt19937_64 rng(30);
  SearchProblem problem;
  problem.controls = models::standard_primitives();
  problem.controls.push_back({0.0, 0.0});
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  for (int i = 0; i < 500; ++i) {
    const Pose2 from = random_pose(rng);
    for (int c = 0; c < motion.control_count(); ++c) {
      const Pose2 expected = models::step_unicycle(
          from, problem.controls[static_cast<std::size_t>(c)], problem.step_s);
      const Pose2 to = motion.child(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), c);
      EXPECT_NEAR(to.x_m, expected.x_m, 1e-12);
      EXPECT_NEAR(to.y_m, expected.y_m, 1e-12);
      EXPECT_NEAR(wrap_to_pi(to.yaw_rad - expected.yaw_rad), 0.0, 1e-12);
    }
  }
}

// A problem may have at most 64 controls.
TEST(MotionTable, HasCapacityForAllControls) {
  std::mt19937_64 rng(37);
  SearchProblem problem;
  for (int c = 0; c < 64; ++c) {
    problem.controls.push_back({uniform(rng, 0.0, 3.0), uniform(rng, -3.0, 3.0)});
  }
  MotionTable motion(64, 16, 4);
  motion.reset(problem);
  const Pose2 from = random_pose(rng);
  const double cos_yaw = std::cos(from.yaw_rad);
  const double sin_yaw = std::sin(from.yaw_rad);
  Views children;
  motion.children(from, cos_yaw, sin_yaw, children);
  ASSERT_EQ(children.count, 64);
  for (int c = 0; c < 64; ++c) {
    const Pose2 to = motion.child(from, cos_yaw, sin_yaw, c);
    EXPECT_NEAR(children.x_m[c], to.x_m, 1e-12) << c;
    EXPECT_NEAR(children.y_m[c], to.y_m, 1e-12) << c;
    EXPECT_NEAR(children.cos_yaw[c], std::cos(to.yaw_rad), 1e-12) << c;
    EXPECT_NEAR(children.sin_yaw[c], std::sin(to.yaw_rad), 1e-12) << c;
  }
}

TEST(IsFree, IsTrueIfAndOnlyIfClear) {
  std::mt19937_64 rng(31);
  int freed = 0;
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    const models::World world = random_world(rng);
    const models::DistanceField field(world, 0.1);
    SearchProblem problem;
    problem.controls = models::standard_primitives();
    problem.world = &world;
    problem.clearance_m = pick(rng, 0, 1) == 0 ? 0.0 : uniform(rng, 0.0, 0.5);
    MotionTable exact(64, 16, 4);
    exact.reset(problem);
    SearchProblem by_field = problem;  // one table uses the distance field
    by_field.field = &field;
    MotionTable fast(64, 16, 4);
    fast.reset(by_field);
    for (int k = 0; k < 20; ++k) {
      const Pose2 from = random_pose(rng);
      const double cos_yaw = std::cos(from.yaw_rad);
      const double sin_yaw = std::sin(from.yaw_rad);
      for (int c = 0; c < exact.control_count(); ++c) {
        const models::UnicycleControl control = problem.controls[static_cast<std::size_t>(c)];
        const double sampled_m = sampled_clearance_m(world, from, control, problem.step_s);
        const bool free = exact.is_free(from, cos_yaw, sin_yaw, c, 0);
        EXPECT_EQ(fast.is_free(from, cos_yaw, sin_yaw, c, 0), free);
        if (free) {
          ++freed;
          EXPECT_GT(sampled_m, problem.clearance_m);
        } else {
          ++refused;  // clearance may drop between samples
          EXPECT_LE(sampled_m, problem.clearance_m + 1.5 / 500.0 + 1e-5);
        }
      }
    }
  }
  EXPECT_GT(freed, 1000);
  EXPECT_GT(refused, 1000);
}

// The starts are within a cell of contact, where the table selects the distance field or exact
// distances. The answer must equal that of arc_is_clear().
TEST(IsFree, FieldNeverAcceptsWhatExactDistancesRefuse) {
  std::mt19937_64 rng(33);
  int grazing = 0;
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    const models::World world = random_world(rng);
    const models::DistanceField field(world, pick(rng, 0, 1) == 0 ? 0.05 : 0.3);
    SearchProblem problem;
    problem.controls = models::standard_primitives();
    problem.controls.push_back({0.0, 1.0});
    problem.world = &world;
    problem.field = &field;
    problem.clearance_m = pick(rng, 0, 1) == 0 ? 0.0 : uniform(rng, 0.0, 0.5);
    MotionTable motion(64, 16, 4);
    motion.reset(problem);
    for (int k = 0; k < 100; ++k) {
      Pose2 from = random_pose(rng);
      for (int nearer = 0; nearer < 8; ++nearer) {  // moves to within 0.1 m of contact
        const Eigen::Vector2d p_m = from.position_m();
        const double spare_m = models::clearance_m(world, p_m) - problem.clearance_m;
        const Eigen::Vector2d dx(1e-6, 0.0);
        const Eigen::Vector2d dy(0.0, 1e-6);
        const Eigen::Vector2d up(
            models::clearance_m(world, p_m + dx) - models::clearance_m(world, p_m - dx),
            models::clearance_m(world, p_m + dy) - models::clearance_m(world, p_m - dy));
        const double to_go_m = spare_m - uniform(rng, -1e-3, 0.1);
        if (up.norm() > 0.0) {
          from.x_m -= to_go_m * up.x() / up.norm();
          from.y_m -= to_go_m * up.y() / up.norm();
        }
      }
      from.yaw_rad = uniform(rng, -kPi, kPi);
      for (int c = 0; c < motion.control_count(); ++c) {
        const bool clear = arc_is_clear(world, from, problem.controls[static_cast<std::size_t>(c)],
                                        problem.step_s, problem.clearance_m);
        const bool accepted =
            motion.is_free(from, std::cos(from.yaw_rad), std::sin(from.yaw_rad), c, 0);
        ASSERT_TRUE(clear || !accepted) << "world " << i << " control " << c;
        ASSERT_EQ(accepted, clear) << "world " << i << " control " << c;
        grazing += clear ? 1 : 0;
        refused += clear ? 0 : 1;
      }
    }
  }
  EXPECT_GT(grazing, 20'000);
  EXPECT_GT(refused, 20'000);
}

TEST(CanStop, IsTrueIfAndOnlyIfTheStopIsClear) {
  std::mt19937_64 rng(32);
  int stops = 0;
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    const models::World world = random_world(rng);
    SearchProblem problem;
    problem.controls = models::standard_primitives();
    problem.world = &world;
    problem.clearance_m = uniform(rng, 0.0, 0.4);
    problem.brake_mps2 = uniform(rng, 1.0, 6.0);
    MotionTable motion(64, 16, 4);
    motion.reset(problem);
    for (int k = 0; k < 20; ++k) {
      const Pose2 at = random_pose(rng);
      for (const int c : {0, 5}) {
        const double speed_mps = problem.controls[static_cast<std::size_t>(c)].speed_mps;
        const double way_m = 0.5 * speed_mps * speed_mps / problem.brake_mps2;
        const double sampled_m = sampled_clearance_m(world, at, {way_m, 0.0}, 1.0);
        if (motion.can_stop(at, c, 1)) {
          ++stops;
          EXPECT_GT(sampled_m, problem.clearance_m);
        } else {
          ++refused;
          EXPECT_LE(sampled_m, problem.clearance_m + way_m / 500.0 + 1e-5);
        }
      }
    }
  }
  EXPECT_GT(stops, 500);
  EXPECT_GT(refused, 500);
}

// Returns the least distance in space, m, sampled at 1 ms until both motions have ended.
double sampled_separation_m(const models::Trajectory& a, const models::Trajectory& b, Time from) {
  const Time last = std::max(models::end_time(a), models::end_time(b)) + from_seconds(0.1);
  double least_m = std::numeric_limits<double>::infinity();
  for (Time t = from; t < last; t += from_seconds(0.001)) {
    const Eigen::Vector2d offset = models::at(a, t).world_from_body.position_m() -
                                   models::at(b, t).world_from_body.position_m();
    least_m = std::min(least_m, std::hypot(offset.norm(), a.height_m - b.height_m));
  }
  return least_m;
}

struct TeamProblem {
  models::World world;
  models::DistanceField field;
  SearchProblem problem;
};

// Returns a problem with teammates in a small arena. They start at other times than the robot, have
// other steps, and some continue long after the robot's horizon. Their pieces therefore do not
// align with those of the robot.
std::unique_ptr<TeamProblem> team_problem(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  auto team = std::make_unique<TeamProblem>();
  SearchProblem& problem = team->problem;
  problem.start_time = from_utime(1'700'000'000'000'000);
  problem.start = {uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0), uniform(rng, -kPi, kPi)};
  problem.height_m = 1.0 + (pick(rng, 0, 2) == 0 ? uniform(rng, -0.4, 0.4) : 0.0);
  problem.controls = models::standard_primitives();
  problem.horizon_steps = pick(rng, 2, 6);
  problem.separation_m = uniform(rng, 0.3, 0.8);
  problem.brake_mps2 = uniform(rng, 2.0, 6.0);
  problem.start_speed_mps = pick(rng, 0, 1) == 0 ? 0.0 : 1.0;
  models::SensorModel sensor;
  problem.sensors = {sensor};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d(uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0)),
                       Eigen::Matrix2d::Identity()}}};
  if (pick(rng, 0, 1) == 1) {
    team->world = random_world(rng);
    team->field = models::DistanceField(team->world, 0.1);
    problem.world = &team->world;
    problem.field = &team->field;
    problem.clearance_m = 0.2;
  }
  for (int i = pick(rng, 1, 3); i > 0; --i) {
    const double step_s = pick(rng, 0, 1) == 0 ? 0.5 : uniform(rng, 0.05, 0.6);
    models::Trajectory teammate =
        test::random_teammate(rng, problem.start_time, pick(rng, 0, 12), step_s);
    if (pick(rng, 0, 3) == 0) {
      for (models::PlanSegment& segment : teammate.segments) {
        segment.control.speed_mps *= -1.0;  // teammates may drive in reverse
      }
    }
    problem.teammates.push_back(teammate);
  }
  return team;
}

TEST(Plans, KeepSeparationAndEndInASafeHover) {
  ReducedValueIteration search({20'000, 200'000, 4, 8, 4});
  int found = 0;
  int stopped_early = 0;
  int close = 0;
  int above = 0;
  for (std::uint64_t seed = 0; seed < 160; ++seed) {
    const auto team = team_problem(seed);
    SearchProblem& problem = team->problem;
    problem.separation_from_above = seed % 3 == 0;
    const SearchResult& result =
        search.plan(problem, {}, Deadline::nodes(seed % 5 == 0 ? 30 : 3'000));
    if (!result.found) {
      continue;
    }
    ++found;
    stopped_early += result.moving_steps < problem.horizon_steps ? 1 : 0;
    const models::Trajectory plan = to_trajectory(problem, result);
    for (std::size_t i = 0; i < problem.teammates.size(); ++i) {
      models::Trajectory teammate = problem.teammates[i];
      const double kept_m = required_separation_m(problem, i);
      above += teammate.height_m != problem.height_m && problem.separation_from_above ? 1 : 0;
      if (problem.separation_from_above) {
        teammate.height_m = problem.height_m;
      }
      const double sampled_m = sampled_separation_m(plan, teammate, problem.start_time);
      EXPECT_GE(sampled_m, kept_m - 1e-5) << "seed " << seed;
      EXPECT_TRUE(models::keeps_separation(plan, teammate, problem.start_time, kept_m - 1e-5))
          << "seed " << seed;
      close += sampled_m < problem.separation_m + 0.3 ? 1 : 0;
    }
    if (problem.world != nullptr) {
      EXPECT_TRUE(
          models::is_clear(team->world, plan, problem.start_time, problem.clearance_m - 1e-5))
          << "seed " << seed;
      for (Time t = problem.start_time; t < models::end_time(plan) + from_seconds(0.01);
           t += from_seconds(0.002)) {
        EXPECT_GT(
            models::clearance_m(team->world, models::at(plan, t).world_from_body.position_m()),
            problem.clearance_m - 1e-9);
      }
    }
    EXPECT_EQ(models::at(plan, models::end_time(plan) + from_seconds(1.0)).control,
              models::UnicycleControl{});
  }
  EXPECT_GT(found, 80);
  EXPECT_GT(stopped_early, 3);
  EXPECT_GT(close, 20);
  EXPECT_GT(above, 5);
}

TEST(Plans, MoveAwayFromATooNearTeammate) {
  ReducedValueIteration search({20'000, 200'000, 4, 8, 4});
  std::mt19937_64 rng(5);
  for (int i = 0; i < 40; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    const double to_rad = uniform(rng, -kPi, kPi);
    problem.start = {0.0, 0.0, to_rad + uniform(rng, -1.0, 1.0)};
    problem.height_m = 1.5;
    problem.controls = models::lab_primitives();
    problem.horizon_steps = 6;
    problem.separation_m = 1.0;
    problem.brake_mps2 = 2.0;
    problem.sensors = {models::SensorModel{}};
    problem.targets = {
        {{models::TargetKind::kStatic, 2, 0.0},
         {3.0 * Eigen::Vector2d(std::cos(to_rad), std::sin(to_rad)), Eigen::Matrix2d::Identity()}}};
    models::Trajectory hover;  // behind and above the robot
    hover.start_time = problem.start_time;
    hover.height_m = 2.0;
    hover.start = {-0.6 * std::cos(to_rad), -0.6 * std::sin(to_rad), 0.0};
    problem.teammates = {hover};
    const double now_m = std::hypot(0.6, 0.5);
    EXPECT_NEAR(required_separation_m(problem, 0), now_m - 0.01, 1e-12);
    models::Trajectory own;  // a motion keeps the separation of a plan
    own.start = problem.start;
    own.height_m = problem.height_m;
    EXPECT_EQ(required_separation_m(problem, own, hover), required_separation_m(problem, 0));
    EXPECT_NEAR(required_separation_m(problem, hover, own), now_m - 0.01, 1e-12);
    const SearchResult& result = search.plan(problem, {}, Deadline::nodes(20'000));
    ASSERT_TRUE(result.found) << i;
    EXPECT_EQ(result.moving_steps, problem.horizon_steps) << i;
    const models::Trajectory plan = to_trajectory(problem, result);
    EXPECT_GE(sampled_separation_m(plan, hover, problem.start_time), now_m - 0.01 - 1e-9);
    hover.start.x_m *= 2.0;
    hover.start.y_m *= 2.0;
    problem.teammates = {hover};
    EXPECT_EQ(required_separation_m(problem, 0), problem.separation_m);  // far away
  }
}

// An arc and the same arc in reverse sweep the same area, so both have the same result.
TEST(ArcIsClear, IsSymmetricInDirection) {
  std::mt19937_64 rng(36);
  int clear = 0;
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const models::World world = random_world(rng);
    for (int k = 0; k < 50; ++k) {
      const Pose2 from = random_pose(rng);
      const models::UnicycleControl there{uniform(rng, 0.5, 3.0),
                                          pick(rng, 0, 3) == 0 ? 0.0 : uniform(rng, -3.0, 3.0)};
      const models::UnicycleControl back{-there.speed_mps, -there.yaw_rate_radps};
      const double radius_m = uniform(rng, 0.0, 0.4);
      constexpr double kDuration_s = 0.7;
      const Pose2 to = models::step_unicycle(from, there, kDuration_s);
      if (std::abs(sampled_clearance_m(world, from, there, kDuration_s) - radius_m) < 0.01) {
        continue;  // within rounding
      }
      const bool is_clear = arc_is_clear(world, from, there, kDuration_s, radius_m);
      EXPECT_EQ(arc_is_clear(world, to, back, kDuration_s, radius_m), is_clear) << i << ' ' << k;
      (is_clear ? clear : touching) += 1;
    }
  }
  EXPECT_GT(clear, 500);
  EXPECT_GT(touching, 500);
}

}  // namespace
}  // namespace vantage::planner
