#include "drivers/safety/plan_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "models/plan/plan.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/drivers/safety/held.hpp"
#include "test/support/bisect.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

using test::held;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

SafetyLimits limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

/// Returns limits for a room without walls or obstacles nearby.
SafetyLimits open_limits() {
  SafetyLimits out = limits();
  out.fence.bounds = {{-100.0, -100.0}, {100.0, 100.0}};
  out.fence.obstacles.clear();
  return out;
}

models::Trajectory random_way(test::Random& random) {
  models::Trajectory way;
  way.start_time = kStart;
  way.start = {random.uniform(-3.5, 3.5), random.uniform(-1.8, 1.8), random.uniform(-kPi, kPi)};
  way.height_m = 1.0;
  const double rates_radps[] = {0.0, 1.0, -1.0, 3.0, -3.0};
  for (int i = random.integer(1, 5); i > 0; --i) {
    way.segments.push_back({{1.0, rates_radps[random.integer(0, 4)]}, 0.5, 0.0});
  }
  way.segments.push_back(models::brake(1.0, 2.0).front());
  return way;
}

// Compares the results of two independent closed forms of the same motion.
TEST(PointAt, AgreesWithTheModelsTrajectory) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const models::Trajectory way = random_way(random);
    const double t_s = random.uniform(-0.5, 4.0);
    const Setpoint ours = point_at(held(way), t_s);
    const models::TrajectoryPoint theirs = models::at(way, kStart + from_seconds(t_s));
    const Pose2& pose = theirs.world_from_body;
    EXPECT_NEAR(ours.position_world_m.x(), pose.x_m, 1e-5);
    EXPECT_NEAR(ours.position_world_m.y(), pose.y_m, 1e-5);
    EXPECT_NEAR(wrap_to_pi(ours.yaw_rad - pose.yaw_rad), 0.0, 1e-5);
  }
}

// The reference is a brute-force check that samples the path every millisecond with the same
// distance functions.
TEST(CheckPath, AgreesWithSamplesEveryMillisecond) {
  test::Random random(4);
  const SafetyLimits lim = limits();
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    const HeldPlan plan = held(random_way(random));
    models::Trajectory other_way = random_way(random);
    const HeldPlan other = held(other_way);
    const OtherCourse others[] = {{&other, Eigen::Vector3d::Zero()}};
    double fence_m = 1e9;
    double obstacle_m = 1e9;
    double apart_m = 1e9;
    for (int ms = 0; ms <= 4000; ++ms) {
      const Eigen::Vector3d p_m = point_at(plan, 1e-3 * ms).position_world_m;
      fence_m = std::min(fence_m, fence_distance_m(lim.fence, p_m.head<2>()));
      obstacle_m = std::min(obstacle_m, obstacle_distance_m(lim.fence, p_m.head<2>()));
      apart_m = std::min(apart_m, (p_m - point_at(other, 1e-3 * ms).position_world_m).norm());
    }
    const double least_m =
        std::min({fence_m - lim.vehicle.radius_m, obstacle_m - lim.vehicle.radius_m,
                  apart_m - lim.plan_separation_m});
    const bool passes = check_path(plan, kStart, lim, others) == PlanVerdict::kAccepted;
    if (std::abs(least_m) > 0.003) {
      EXPECT_EQ(passes, least_m > 0.0) << "least distance " << least_m;
    }
    refused += passes ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 395);
}

// The shared models compute the swept clearance by another method. They must accept every plan that
// flight safety accepts.
TEST(CheckPath, AcceptsOnlyPathsThatAreClearInTheModels) {
  test::Random random(5);
  const SafetyLimits lim = limits();
  int accepted = 0;
  for (int i = 0; i < 2000; ++i) {
    const models::Trajectory way = random_way(random);
    if (check_path(held(way), kStart, lim, {}) == PlanVerdict::kAccepted) {
      ++accepted;
      EXPECT_TRUE(models::is_clear(lim.fence, way, kStart, lim.vehicle.radius_m - 0.003));
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(CheckPath, ChecksTheHoverAfterThePlan) {
  const SafetyLimits lim = limits();
  models::Trajectory still;
  still.start_time = kStart;
  still.start = {2.0, -1.3, 0.0};
  still.height_m = 1.0;
  models::Trajectory comes = still;
  comes.start.x_m = -2.0;
  comes.segments = {{{1.0, 0.0}, 3.9, 0.0}, models::brake(1.0, 2.0).front()};
  const HeldPlan other = held(comes);
  const OtherCourse others[] = {{&other, Eigen::Vector3d::Zero()}};
  EXPECT_EQ(check_path(held(still), kStart, lim, others), PlanVerdict::kTeammate);
  EXPECT_EQ(check_path(held(still), kStart, lim, {}), PlanVerdict::kAccepted);
}

TEST(CheckPath, KeepsBelowTheCeilingAndAboveTheGround) {
  const SafetyLimits lim = limits();
  models::Trajectory way;
  way.start_time = kStart;
  for (const double height_m : {-0.1, 0.0, 3.0, 5.0}) {
    way.height_m = height_m;
    EXPECT_EQ(check_path(held(way), kStart, lim, {}), PlanVerdict::kOutsideFence) << height_m;
  }
}

TEST(CheckShape, RefusesInfeasiblePlans) {
  const SafetyLimits lim = limits();
  const models::PlanSegment stop = models::brake(1.0, 2.0).front();
  const auto verdict = [&](std::vector<models::PlanSegment> segments) {
    models::Trajectory way;
    way.start_time = kStart;
    way.height_m = 1.0;
    way.segments = std::move(segments);
    return check_shape(held(way), lim);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(verdict({}), PlanVerdict::kAccepted);
  EXPECT_EQ(verdict({{{1.0, 3.0}, 0.5, 0.0}, stop}), PlanVerdict::kAccepted);
  EXPECT_EQ(verdict({{{nan, 0.0}, 0.5, 0.0}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.0, inf}, 0.5, 0.0}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.0, 0.0}, nan, 0.0}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.0, 0.0}, -1.0, 0.0}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.0, 0.0}, 1e9, 0.0}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.0, 0.0}, 0.5, nan}, stop}), PlanVerdict::kNotFinite);
  EXPECT_EQ(verdict({{{1.01, 0.0}, 0.5, 0.0}, stop}), PlanVerdict::kInfeasible);
  EXPECT_EQ(verdict({{{1.0, 3.1}, 0.5, 0.0}, stop}), PlanVerdict::kInfeasible);
  EXPECT_EQ(verdict({{{1.0, 0.0}, 0.4, 2.5}}), PlanVerdict::kInfeasible);
  EXPECT_EQ(verdict({{{-1.0, 0.0}, 0.5, 0.0}, {{1.0, 0.0}, 0.5, 0.0}, stop}),
            PlanVerdict::kInfeasible);
  EXPECT_EQ(verdict({{{1.0, 0.0}, 0.5, 0.0}}), PlanVerdict::kNoHover);
  EXPECT_EQ(verdict({{{1.0, 0.0}, 0.3, 2.0}}), PlanVerdict::kNoHover);
}

TEST(HoldPlan, RefusesTooManySegments) {
  models::Trajectory way;
  way.segments.resize(HeldPlan::kSegmentsMax + 1);
  HeldPlan plan;
  EXPECT_FALSE(hold_plan(way, plan));
}

// A turn rate too small for an arc still turns the yaw, to the correct side.
TEST(PointAt, TurnsAtVerySmallRates) {
  HeldPlan plan;
  plan.start = {0.0, 0.0, 0.5};
  plan.count = 1;
  for (const double w_radps : {-1.1e-6, -0.9e-6, 0.0, 0.9e-6, 1.1e-6}) {
    plan.segments[0] = {{1.0, w_radps}, 50.0, 0.0};
    const Setpoint here = point_at(plan, 40.0);
    EXPECT_NEAR(here.yaw_rad - 0.5, 40.0 * w_radps, 1e-12) << w_radps;
    EXPECT_EQ(here.yaw_rate_radps, w_radps);
  }
}

// The result is the greatest speed between two times, for forward and backward motion.
TEST(SpeedMax, IsTheGreatestSpeedWithinTheGivenTime) {
  HeldPlan plan;
  plan.count = 3;
  plan.segments[0] = {{0.5, 0.0}, 1.0, 0.0};
  plan.segments[1] = {{-0.9, 1.0}, 2.0, 0.0};
  plan.segments[2] = {{0.2, 0.0}, 1.0, 0.2};
  plan.segments[3] = {{7.0, 0.0}, 9.0, 0.0};  // remains from an earlier plan
  struct Window {
    double from_s, to_s, fastest_mps;
  };
  for (const Window& window : {Window{0.0, 60.0, 0.9}, Window{0.0, 0.9, 0.5}, Window{0.0, 1.1, 0.9},
                               Window{2.9, 60.0, 0.9}, Window{3.1, 60.0, 0.2},
                               Window{1.5, 1.6, 0.9}, Window{4.1, 60.0, 0.0}}) {
    EXPECT_EQ(speed_max_mps(plan, window.from_s, window.to_s), window.fastest_mps)
        << window.from_s << " " << window.to_s;
  }
}

TEST(PlanVerdict, EachHasAName) {
  const std::vector<std::pair<PlanVerdict, std::string>> names = {
      {PlanVerdict::kAccepted, "accepted"},
      {PlanVerdict::kWrongVehicle, "wrong vehicle"},
      {PlanVerdict::kStale, "stale"},
      {PlanVerdict::kTooFarAhead, "too far ahead"},
      {PlanVerdict::kNotFinite, "not finite"},
      {PlanVerdict::kInfeasible, "infeasible"},
      {PlanVerdict::kNoHover, "no hover"},
      {PlanVerdict::kNoLease, "no lease"},
      {PlanVerdict::kNotFollowing, "not following"},
      {PlanVerdict::kDiscontinuous, "discontinuous"},
      {PlanVerdict::kOutsideFence, "out of fence"},
      {PlanVerdict::kObstacle, "obstacle"},
      {PlanVerdict::kTeammate, "teammate"},
      {PlanVerdict::kTooCostly, "too costly"},
  };
  EXPECT_EQ(names.size(), kPlanVerdicts);
  for (const auto& [verdict, name] : names) {
    EXPECT_EQ(name_of(verdict), name);
  }
}

// A plan with any value that is not finite is refused with this verdict before all other checks.
TEST(CheckShape, RefusesNonFiniteValues) {
  const SafetyLimits lim = limits();
  const std::vector<double* (*)(HeldPlan&)> numbers = {
      [](HeldPlan& p) { return &p.start.x_m; },
      [](HeldPlan& p) { return &p.start.y_m; },
      [](HeldPlan& p) { return &p.start.yaw_rad; },
      [](HeldPlan& p) { return &p.height_m; },
      [](HeldPlan& p) { return &p.segments[0].control.speed_mps; },
      [](HeldPlan& p) { return &p.segments[0].control.yaw_rate_radps; },
      [](HeldPlan& p) { return &p.segments[0].duration_s; },
      [](HeldPlan& p) { return &p.segments[0].brake_mps2; },
      [](HeldPlan& p) { return &p.segments[1].control.speed_mps; },
      [](HeldPlan& p) { return &p.segments[1].control.yaw_rate_radps; },
      [](HeldPlan& p) { return &p.segments[1].duration_s; },
      [](HeldPlan& p) { return &p.segments[1].brake_mps2; },
  };
  models::Trajectory way;
  way.start_time = kStart;
  way.height_m = 1.0;
  way.segments = {{{1.0, 0.0}, 0.5, 0.0}, models::brake(1.0, 2.0).front()};
  EXPECT_EQ(check_shape(held(way), lim), PlanVerdict::kAccepted);
  const double inf = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), inf, -inf}) {
      HeldPlan plan = held(way);
      *numbers[i](plan) = value;
      EXPECT_EQ(check_shape(plan, lim), PlanVerdict::kNotFinite) << i << " is " << value;
    }
  }
  // The greatest finite number passes this check, but makes the plan infeasible.
  HeldPlan plan = held(way);
  for (double* number :
       {&plan.segments[0].control.speed_mps, &plan.segments[0].control.yaw_rate_radps}) {
    for (const double value : {1e308, -1e308}) {
      *number = value;
      EXPECT_EQ(check_shape(plan, lim), PlanVerdict::kInfeasible) << value;
    }
    *number = 0.0;
  }
}

// Message encoding rounds values, so each limit may be exceeded by 1e-6 of its value. This
// tolerance applies forwards and backwards, to left and right turns, and to segments that change
// the speed in steps.
TEST(CheckShape, ToleratesARelativeExcessOfOneMillionth) {
  SafetyLimits lim = limits();
  lim.vehicle.speed_max_mps = 0.8;
  lim.vehicle.yaw_rate_max_radps = 2.5;
  lim.vehicle.brake_mps2 = 1.6;
  lim.lateral_max_mps2 = 1.1;
  const auto accepts = [&](std::vector<models::PlanSegment> segments) {
    models::Trajectory way;
    way.start_time = kStart;
    way.height_m = 1.0;
    way.segments = std::move(segments);
    return check_shape(held(way), lim) == PlanVerdict::kAccepted;
  };
  const auto forgiven = [](double limit, const auto& accepts_at) {
    return test::last_accepted(0.99 * limit, 2.0 * limit, 1e-11, accepts_at) / limit - 1.0;
  };
  const models::PlanSegment rest{{}, 0.1, 0.0};
  for (const double sign : {1.0, -1.0}) {
    SCOPED_TRACE(sign);
    const models::PlanSegment half{{sign * 0.4, 0.0}, 0.5, 0.0};
    const double speed = forgiven(0.8, [&](double v) {
      return accepts({half, {{sign * v, 0.0}, 0.5, 0.0}, half, rest});
    });
    EXPECT_NEAR(speed, 1e-6, 1e-9);
    const double change = forgiven(0.8, [&](double change_mps) {
      const double before_mps = -0.3 * sign;
      return accepts(
          {{{before_mps, 0.0}, 0.5, 0.0}, {{before_mps + sign * change_mps, 0.0}, 0.5, 0.0}, rest});
    });
    EXPECT_NEAR(change, 1e-6, 1e-9);
    const double brake = forgiven(1.6, [&](double a) {
      return accepts({{{sign * 0.8, 0.0}, 1.0, a}});
    });
    EXPECT_NEAR(brake, 1e-6, 1e-9);
    for (const double side : {1.0, -1.0}) {
      const double turn = forgiven(2.5, [&](double w) {
        return accepts({{{sign * 0.2, side * w}, 0.5, 0.0}, rest});
      });
      EXPECT_NEAR(turn, 1e-6, 1e-9);
      const double tight = forgiven(1.1, [&](double lateral_mps2) {
        return accepts({{{sign * 0.8, side * lateral_mps2 / 0.8}, 0.5, 0.0}, rest});
      });
      EXPECT_NEAR(tight, 1e-6, 1e-9);
    }
    // A stop may be 1e-6 s too short and may also leave a speed of 1e-6 m/s.
    const double stop_s = test::last_accepted(1.0, 0.0, 1e-12, [&](double t_s) {
      return accepts({{{sign * 0.8, 0.0}, t_s, 1.6}});
    });
    EXPECT_NEAR(0.8 / 1.6 - stop_s, 1e-6 + 1e-6 / 1.6, 1e-10);
    // A plan that does not end with a stop must already have a final speed of 0, to 1e-6 m/s.
    const double left_mps = test::last_accepted(0.0, 0.1, 1e-12, [&](double v) {
      return accepts({half, {{sign * v, 0.0}, 0.1, 0.0}});
    });
    EXPECT_NEAR(left_mps, 1e-6, 1e-10);
  }
}

// The distance is that to the nearest obstacle, from outside and inside, in any order of the list.
TEST(Distances, AreMeasuredToTheNearestOfAllObstacles) {
  test::Random random(38);
  for (int i = 0; i < 300; ++i) {
    models::World world;
    const Eigen::Vector2d p_m = random.vector<2>(-3.0, 3.0);
    double least_m = std::numeric_limits<double>::infinity();
    EXPECT_EQ(obstacle_distance_m(world, p_m), least_m);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d low_m = random.vector<2>(-3.0, 3.0);
      const models::Obstacle obstacle{{low_m, low_m + random.vector<2>(0.1, 2.0)}, 1.0};
      models::World alone;
      alone.obstacles = {obstacle};
      least_m = std::min(least_m, obstacle_distance_m(alone, p_m));
      world.obstacles.push_back(obstacle);
      EXPECT_EQ(obstacle_distance_m(world, p_m), least_m);
    }
    std::reverse(world.obstacles.begin(), world.obstacles.end());
    EXPECT_EQ(obstacle_distance_m(world, p_m), least_m);
  }
}

// The reference is a brute-force search over a fine grid of points on the edge of the rectangle.
TEST(Distances, AreMeasuredToTheNearestPointOfTheEdge) {
  test::Random random(34);
  for (int i = 0; i < 300; ++i) {
    models::World world;
    const Eigen::Vector2d low_m = random.vector<2>(-1.0, 0.5);
    const Eigen::Vector2d high_m = low_m + random.vector<2>(0.1, 1.5);
    world.bounds = {low_m, high_m};
    world.obstacles = {{{low_m, high_m}, 1.0}};
    const Eigen::Vector2d p_m = random.vector<2>(-2.0, 2.0);
    double edge_m = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) {
      const Eigen::Vector2d at_m = low_m + k / 2000.0 * (high_m - low_m);
      for (const Eigen::Vector2d& q_m :
           {Eigen::Vector2d(at_m.x(), low_m.y()), Eigen::Vector2d(at_m.x(), high_m.y()),
            Eigen::Vector2d(low_m.x(), at_m.y()), Eigen::Vector2d(high_m.x(), at_m.y())}) {
        edge_m = std::min(edge_m, (p_m - q_m).norm());
      }
    }
    const bool is_inside =
        (p_m.array() > low_m.array()).all() && (p_m.array() < high_m.array()).all();
    const double outside_m = is_inside ? -edge_m : edge_m;
    EXPECT_NEAR(obstacle_distance_m(world, p_m), outside_m, 1e-3);
    EXPECT_NEAR(fence_distance_m(world, p_m), -outside_m, 1e-3);
  }
}

/// Returns a path from x = 0 along the x axis: 3 s at 1 m/s and a stop at x = 3.25 m.
HeldPlan drive(double start_s, double y_m = 0.0) {
  models::Trajectory way;
  way.start_time = kStart + from_seconds(start_s);
  way.start = {0.0, y_m, 0.0};
  way.height_m = 1.0;
  way.segments = {{{1.0, 0.0}, 3.0, 0.0}, models::brake(1.0, 2.0).front()};
  return held(way);
}

HeldPlan hover(double start_s, double x_m, double y_m) {
  models::Trajectory way;
  way.start_time = kStart + from_seconds(start_s);
  way.start = {x_m, y_m, 0.0};
  way.height_m = 1.0;
  return held(way);
}

// Every path is checked to its end, to the centimetre, for any start times. A teammate may have
// been at rest for a long time.
TEST(CheckPath, ChecksEveryPathToItsEnd) {
  SafetyLimits lim = open_limits();
  lim.plan_separation_m = 0.5;
  const HeldPlan over = hover(-100.0, 50.0, 0.0);
  for (const double start_s : {-3.4, -3.0, -1.0, 0.0, 0.5, 2.0, 7.0}) {
    for (const double apart_m : {0.49, 0.51}) {
      SCOPED_TRACE(testing::Message() << start_s << " s, " << apart_m << " m");
      const bool is_apart = apart_m > lim.plan_separation_m;
      const PlanVerdict expected = is_apart ? PlanVerdict::kAccepted : PlanVerdict::kTeammate;
      const double end_m = 3.25 + apart_m;
      const HeldPlan drives = drive(start_s);
      const HeldPlan stands = hover(-0.5, end_m, 0.0);
      const OtherCourse body{nullptr, {end_m, 0.0, 1.0}};
      for (const OtherCourse& other : {body, OtherCourse{&stands, {}}}) {
        const std::vector<OtherCourse> alone = {other};
        const std::vector<OtherCourse> first = {other, {&over, {}}};
        const std::vector<OtherCourse> last = {{&over, {}}, other};
        for (const auto& others : {alone, first, last}) {
          EXPECT_EQ(check_path(drives, kStart, lim, others), expected) << others.size();
        }
      }
      const OtherCourse comes{&drives, {}};
      const std::vector<OtherCourse> alone = {comes};
      const std::vector<OtherCourse> first = {comes, {&over, {}}};
      const std::vector<OtherCourse> last = {{&over, {}}, comes};
      for (const auto& others : {alone, first, last}) {
        EXPECT_EQ(check_path(stands, kStart, lim, others), expected) << others.size();
      }
      // The same path ends before a wall.
      SafetyLimits walled = open_limits();
      const double face_m = 3.25 + walled.vehicle.radius_m + (is_apart ? 0.01 : -0.01);
      walled.fence.obstacles = {{{{face_m, -1.0}, {face_m + 1.0, 1.0}}, 2.0}};
      EXPECT_EQ(check_path(drives, kStart, walled, std::vector<OtherCourse>{{&over, {}}}),
                is_apart ? PlanVerdict::kAccepted : PlanVerdict::kObstacle);
    }
  }
}

// A teammate in motion is at the current point of its plan. The flown part of its plan is ignored.
TEST(CheckPath, IgnoresTheFlownPartOfTeammatePlans) {
  SafetyLimits lim = open_limits();
  lim.plan_separation_m = 0.5;
  const HeldPlan passes = drive(0.0, 0.3);  // 0.3 m away at x = 1 m, 0.5 m away at 1.4 m
  const OtherCourse others[] = {{&passes, {}}};
  const double since_s = test::last_accepted(3.0, 0.0, 1e-7, [&](double t_s) {
    const HeldPlan stands = hover(t_s - 0.1, 1.0, 0.0);
    return check_path(stands, kStart + from_seconds(t_s), lim, others) == PlanVerdict::kAccepted;
  });
  EXPECT_NEAR(since_s, 1.4, 5e-6);
  for (const double before_s : {0.0, 0.5, 4.0}) {
    const HeldPlan stands = hover(-before_s, 1.0, 0.0);
    EXPECT_EQ(check_path(stands, kStart - from_seconds(before_s), lim, others),
              PlanVerdict::kTeammate)
        << "the teammate will come closer";
  }
}

// At any speed of the vehicle, a thin wall across the path is a conflict and one next to the path
// is not.
TEST(CheckPath, FindsAThinWallAtAnySpeed) {
  for (const double speed_mps : {0.3, 1.0, 2.0, 3.0, 6.0}) {
    SafetyLimits lim = open_limits();
    lim.vehicle.speed_max_mps = speed_mps;
    models::Trajectory way;
    way.start_time = kStart;
    way.height_m = 1.0;
    way.segments = {{{speed_mps, 0.0}, 12.0 / speed_mps, 0.0}, {{}, 0.1, 0.0}};
    for (double wall_m = 0.5; wall_m < 12.0; wall_m += 0.37) {
      lim.fence.obstacles = {{{{wall_m, -0.1}, {wall_m + 0.01, 0.1}}, 2.0}};
      EXPECT_EQ(check_path(held(way), kStart, lim, {}), PlanVerdict::kObstacle) << wall_m;
      lim.fence.obstacles[0].footprint.min_m.y() = lim.vehicle.radius_m + 0.01;
      lim.fence.obstacles[0].footprint.max_m.y() = 1.0;
      EXPECT_EQ(check_path(held(way), kStart, lim, {}), PlanVerdict::kAccepted) << wall_m;
    }
  }
}

}  // namespace
}  // namespace vantage::drivers
