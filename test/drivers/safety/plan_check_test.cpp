#include "drivers/safety/plan_check.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "models/plan/plan.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

SafetyLimits limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

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

HeldPlan held(const models::Trajectory& way) {
  HeldPlan plan;
  EXPECT_TRUE(hold_plan(way, plan));
  return plan;
}

// Two independent closed forms of the same motion.
TEST(PointAt, AgreesWithTheTrajectoryThatEveryoneElseUses) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const models::Trajectory way = random_way(random);
    const double t_s = random.uniform(-0.5, 4.0);
    const PlanPoint ours = point_at(held(way), t_s);
    const models::TrajectoryPoint theirs = models::at(way, kStart + from_seconds(t_s));
    const Pose2& pose = theirs.world_from_body;
    EXPECT_NEAR(ours.position_world_m.x(), pose.x_m, 1e-5);
    EXPECT_NEAR(ours.position_world_m.y(), pose.y_m, 1e-5);
    EXPECT_NEAR(wrap_to_pi(ours.yaw_rad - pose.yaw_rad), 0.0, 1e-5);
  }
}

// Brute force: every millisecond of the way, by the same distances.
TEST(CheckWay, FindsWhatASampleEachMillisecondFinds) {
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
    const bool passes = check_way(plan, kStart, lim, others) == PlanVerdict::kAccepted;
    if (std::abs(least_m) > 0.003) {
      EXPECT_EQ(passes, least_m > 0.0) << "least room " << least_m;
    }
    refused += passes ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 395);
}

// The shared models know swept clearance by another method; whatever we accept they must, too.
TEST(CheckWay, AcceptsNothingThatTheModelsCallBlocked) {
  test::Random random(5);
  const SafetyLimits lim = limits();
  int accepted = 0;
  for (int i = 0; i < 2000; ++i) {
    const models::Trajectory way = random_way(random);
    if (check_way(held(way), kStart, lim, {}) == PlanVerdict::kAccepted) {
      ++accepted;
      EXPECT_TRUE(models::is_clear(lim.fence, way, kStart, lim.vehicle.radius_m - 0.003));
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(CheckWay, CountsTheHoverAfterTheEnd) {
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
  EXPECT_EQ(check_way(held(still), kStart, lim, others), PlanVerdict::kTeammate);
  EXPECT_EQ(check_way(held(still), kStart, lim, {}), PlanVerdict::kAccepted);
}

TEST(CheckWay, KeepsBelowTheCeilingAndAboveTheGround) {
  const SafetyLimits lim = limits();
  models::Trajectory way;
  way.start_time = kStart;
  for (const double height_m : {-0.1, 0.0, 3.0, 5.0}) {
    way.height_m = height_m;
    EXPECT_EQ(check_way(held(way), kStart, lim, {}), PlanVerdict::kOutsideFence) << height_m;
  }
}

TEST(CheckShape, RefusesWhatNoVehicleCanFly) {
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

TEST(HoldPlan, RefusesMoreSegmentsThanItHasRoomFor) {
  models::Trajectory way;
  way.segments.resize(HeldPlan::kSegmentsMax + 1);
  HeldPlan plan;
  EXPECT_FALSE(hold_plan(way, plan));
}

// What turns too slowly for an arc turns, too: to the side that it says.
TEST(PointAt, TurnsAsSlowlyAsItSaysOnBothSidesOfTheStraightest) {
  HeldPlan plan;
  plan.start = {0.0, 0.0, 0.5};
  plan.count = 1;
  for (const double w_radps : {-1.1e-6, -0.9e-6, 0.0, 0.9e-6, 1.1e-6}) {
    plan.segments[0] = {{1.0, w_radps}, 50.0, 0.0};
    const PlanPoint here = point_at(plan, 40.0);
    EXPECT_NEAR(here.yaw_rad - 0.5, 40.0 * w_radps, 1e-12) << w_radps;
    EXPECT_EQ(here.yaw_rate_radps, w_radps);
  }
}

// What somebody flies at most from one instant to another, forwards or backwards.
TEST(SpeedMax, IsOfWhatIsFlownMeanwhile) {
  HeldPlan plan;
  plan.count = 3;
  plan.segments[0] = {{0.5, 0.0}, 1.0, 0.0};
  plan.segments[1] = {{-0.9, 1.0}, 2.0, 0.0};
  plan.segments[2] = {{0.2, 0.0}, 1.0, 0.2};
  plan.segments[3] = {{7.0, 0.0}, 9.0, 0.0};  // of a plan before it
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

}  // namespace
}  // namespace vantage::drivers
