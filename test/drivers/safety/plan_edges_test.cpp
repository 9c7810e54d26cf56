#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "drivers/safety/plan_check.hpp"
#include "test/drivers/safety/flight_bench.hpp"
#include "test/support/bisect.hpp"
#include "test/support/random.hpp"

// Tests of the plan check at its limits. Random plans pass as closely as allowed; the results must
// not change if the scene is mirrored, rotated, shifted in time or renamed.

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kInf = std::numeric_limits<double>::infinity();

SafetyLimits bench_limits() { return limits_for(test::FlightBench::scenario(), "Q1"); }

/// Returns limits for a room without walls or obstacles nearby.
SafetyLimits open_limits() {
  SafetyLimits limits = bench_limits();
  limits.fence.bounds = {{-100.0, -100.0}, {100.0, 100.0}};
  limits.fence.obstacles.clear();
  return limits;
}

HeldPlan held(Time start, const Pose2& pose, std::vector<models::PlanSegment> segments) {
  models::Trajectory way;
  way.start_time = start;
  way.start = pose;
  way.height_m = 1.0;
  way.segments = std::move(segments);
  HeldPlan plan;
  EXPECT_TRUE(hold_plan(way, plan));
  return plan;
}

// Returns a random plan of driving and turning segments, at most `speed_mps` fast, and a final
// stop.
HeldPlan random_plan(test::Random& random, double speed_mps) {
  std::vector<models::PlanSegment> segments;
  const double speed = speed_mps * random.uniform(0.3, 1.0);
  for (int i = random.integer(1, 5); i > 0; --i) {
    const double rate_radps = random.coin() ? 0.0 : random.uniform(-3.0, 3.0);
    segments.push_back({{speed, rate_radps}, random.uniform(0.2, 0.6), 0.0});
  }
  segments.push_back(models::brake(speed, 2.0).front());
  return held(kStart + from_seconds(random.uniform(-0.5, 0.5)), random.pose2(2.0),
              std::move(segments));
}

/// Returns the same motion, transformed so that it is at `p_m` with yaw `yaw_rad` at `time`.
HeldPlan placed(HeldPlan plan, Time time, const Eigen::Vector2d& p_m, double yaw_rad) {
  const double elapsed_s = to_seconds(time - plan.start_time);
  plan.start = {0.0, 0.0, 0.0};
  const Setpoint there = point_at(plan, elapsed_s);
  plan.start.yaw_rad = wrap_to_pi(yaw_rad - there.yaw_rad);
  const Eigen::Vector2d gone_m =
      Eigen::Rotation2Dd(plan.start.yaw_rad) * there.position_world_m.head<2>();
  plan.start.x_m = p_m.x() - gone_m.x();
  plan.start.y_m = p_m.y() - gone_m.y();
  return plan;
}

/// Returns the least value of `distance_m`, sampled every half millisecond in [now, until].
double sampled_m(Time now, Time until, const std::function<double(Time)>& distance_m) {
  double least_m = kInf;
  for (Time t = now; t <= until; t += Duration{500}) {
    least_m = std::min(least_m, distance_m(t));
  }
  return std::min(least_m, distance_m(until));
}

Eigen::Vector3d place_m(const HeldPlan& plan, Time t) {
  return point_at(plan, to_seconds(t - plan.start_time)).position_world_m;
}

Time end_of(const HeldPlan& plan) { return plan.start_time + from_seconds(duration_s(plan)); }

// m; error of the check, because it steps at least 1 ms at the sum of the two speeds.
constexpr double kStepM = 0.004;

/// Expects that a plan with the least distance `least_m` is refused if and only if `limit_m`
/// exceeds it.
void expect_edge_at(double least_m, double& limit_m, const HeldPlan& plan, Time now,
                    const SafetyLimits& limits, std::span<const OtherCourse> others,
                    PlanVerdict refusal) {
  limit_m = least_m - kStepM;
  EXPECT_EQ(check_path(plan, now, limits, others), PlanVerdict::kAccepted) << least_m;
  limit_m = least_m + kStepM;
  EXPECT_EQ(check_path(plan, now, limits, others), refusal) << least_m;
}

/// Calls look(i, random, plan, now) with random plans, at random times around the start of the
/// plan.
template <class Look>
void for_each_plan(unsigned seed, int count, const Look& look) {
  test::Random random(seed);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const HeldPlan plan = random_plan(random, 1.0);
    const Time now = kStart + from_seconds(random.uniform(-0.3, 0.3));
    look(i, random, plan, now);
  }
}

// Crossing, head-on and overtaking plans are accepted if the required separation is at most the
// least separation found by sampling, otherwise refused.
TEST(CheckPath, FindsTheLeastSeparationOfTwoPlansThatPassClosely) {
  test::Random random(31);
  SafetyLimits limits = open_limits();
  for (int i = 0; i < 600; ++i) {
    const HeldPlan plan = random_plan(random, limits.vehicle.speed_max_mps);
    const Time meets = kStart + from_seconds(random.uniform(0.0, 2.5));
    const Setpoint here = point_at(plan, to_seconds(meets - plan.start_time));
    const double bearing_rad = random.uniform(-kPi, kPi);
    const double apart_m = random.uniform(0.2, 0.9);
    // A teammate may be faster than this vehicle.
    const double yaw_rad = i % 2 == 0 ? here.yaw_rad + kPi : random.uniform(-kPi, kPi);
    const HeldPlan other =
        placed(random_plan(random, i % 3 == 0 ? 2.5 : 1.0), meets,
               here.position_world_m.head<2>() +
                   apart_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)),
               yaw_rad);
    const Time now = kStart + from_seconds(random.uniform(-0.3, 0.3));
    const double least_m =
        sampled_m(now, std::max({now, end_of(plan), end_of(other)}),
                  [&](Time t) { return (place_m(plan, t) - place_m(other, t)).norm(); });
    const OtherCourse others[] = {{&other, Eigen::Vector3d::Zero()}};
    SCOPED_TRACE(i);
    expect_edge_at(least_m, limits.plan_separation_m, plan, now, limits, others,
                   PlanVerdict::kTeammate);
  }
}

TEST(CheckPath, FindsTheLeastDistanceToABodyWithoutAPlan) {
  SafetyLimits limits = open_limits();
  const auto check = [&](int, test::Random& random, const HeldPlan& plan, Time now) {
    const Eigen::Vector3d body_m =
        place_m(plan, now + from_seconds(random.uniform(0.0, 2.5))) + random.vector<3>(-0.6, 0.6);
    const double least_m = sampled_m(now, std::max(now, end_of(plan)),
                                     [&](Time t) { return (place_m(plan, t) - body_m).norm(); });
    const OtherCourse others[] = {{nullptr, body_m}};
    expect_edge_at(least_m, limits.plan_separation_m, plan, now, limits, others,
                   PlanVerdict::kTeammate);
  };
  for_each_plan(32, 300, check);
}

TEST(CheckPath, FindsTheLeastDistanceToFenceAndObstacle) {
  SafetyLimits limits = bench_limits();
  const auto check = [&](int i, test::Random& random, const HeldPlan& plan, Time now) {
    const Eigen::Vector2d near_m =
        place_m(plan, now + from_seconds(random.uniform(0.0, 2.5))).head<2>();
    const Eigen::Vector2d corner_m = near_m + random.vector<2>(-0.6, 0.6);
    PlanVerdict refusal = PlanVerdict::kObstacle;
    if (i % 2 == 0) {
      limits.fence.bounds = {{-100.0, -100.0}, {100.0, 100.0}};
      limits.fence.obstacles = {{{corner_m, corner_m + random.vector<2>(0.02, 0.5)}, 2.5}};
    } else {  // the fence has one edge near the path
      refusal = PlanVerdict::kOutsideFence;
      limits.fence.obstacles.clear();
      limits.fence.bounds = {{-100.0, -100.0}, {100.0, 100.0}};
      double& edge_m = random.coin() ? limits.fence.bounds.min_m(i % 4 / 2)
                                     : limits.fence.bounds.max_m(i % 4 / 2);
      edge_m = near_m(i % 4 / 2) + (edge_m < 0.0 ? -0.4 : 0.4);
    }
    const double least_m = sampled_m(now, std::max(now, end_of(plan)), [&](Time t) {
      const Eigen::Vector2d p_m = place_m(plan, t).head<2>();
      return std::min(fence_distance_m(limits.fence, p_m), obstacle_distance_m(limits.fence, p_m));
    });
    expect_edge_at(least_m, limits.vehicle.radius_m, plan, now, limits, {}, refusal);
  };
  for_each_plan(33, 400, check);
}

// The steps of the check do not miss a body of 2 mm on the path, also at 2 m/s, and a head-on
// teammate with a separation limit of 2 mm.
TEST(CheckPath, FindsThinConflicts) {
  struct Row {
    double speed_mps, separation_m;
    bool is_teammate;
  };
  test::Random random(37);
  SafetyLimits limits = open_limits();
  for (const Row& row : {Row{1.0, 0.001, false}, Row{2.0, 0.00101, false}, Row{1.0, 0.002, true}}) {
    limits.vehicle.speed_max_mps = row.speed_mps;
    limits.plan_separation_m = row.separation_m;
    const std::vector<models::PlanSegment> drive = {{{row.speed_mps, 0.0}, 3.0, 0.0},
                                                    {{}, 0.1, 0.0}};
    for (int i = 0; i < 300; ++i) {
      const HeldPlan plan = held(kStart, random.pose2(2.0), drive);
      const Time meets = kStart + from_seconds(random.uniform(0.05, 2.95));
      const Eigen::Vector3d there_m = place_m(plan, meets);
      const HeldPlan comes =
          placed(held(kStart, {}, drive), meets, there_m.head<2>(), plan.start.yaw_rad + kPi);
      const OtherCourse other[] = {{row.is_teammate ? &comes : nullptr, there_m}};
      EXPECT_EQ(check_path(plan, kStart, limits, other), PlanVerdict::kTeammate)
          << row.speed_mps << " " << row.is_teammate << " " << i;
    }
  }
}

// ---- The same scenes mirrored, rotated, shifted in time and with other names ----

struct Scene {
  HeldPlan plan;
  Time now{};
  std::array<HeldPlan, 2> plans;        // plans of the teammates
  std::vector<Eigen::Vector3d> bodies;  // bodies without a plan
  SafetyLimits limits;

  [[nodiscard]] PlanVerdict verdict() const {
    std::vector<OtherCourse> others = {{&plans[0], Eigen::Vector3d::Zero()},
                                       {&plans[1], Eigen::Vector3d::Zero()}};
    for (const Eigen::Vector3d& body_m : bodies) {
      others.push_back({nullptr, body_m});
    }
    const PlanVerdict shape = check_shape(plan, limits);
    return shape == PlanVerdict::kAccepted ? check_path(plan, now, limits, others) : shape;
  }
};

Scene random_scene(test::Random& random) {
  Scene scene;
  scene.plan = random_plan(random, 1.0);
  scene.now = kStart + from_seconds(random.uniform(-0.3, 0.3));
  scene.plans = {random_plan(random, 1.0), random_plan(random, 1.0)};
  scene.bodies = {random.vector<3>(-3.0, 3.0)};
  scene.limits = bench_limits();
  scene.limits.plan_separation_m = random.uniform(0.1, 0.6);
  scene.limits.vehicle.radius_m = random.uniform(0.02, 0.25);
  scene.limits.lateral_max_mps2 = random.uniform(1.5, 4.0);  // some turns are too tight
  scene.limits.vehicle.yaw_rate_max_radps = random.uniform(2.0, 4.0);
  return scene;
}

/// Transforms positions by `of(x, y)` and yaws by `yaw(yaw)`, and multiplies turn rates by `sense`.
template <class Place, class Yaw>
Scene seen(Scene scene, const Place& of, const Yaw& yaw, double sense) {
  const auto move = [&](HeldPlan& plan) {
    const Eigen::Vector2d start_m = of(plan.start.x_m, plan.start.y_m);
    plan.start = {start_m.x(), start_m.y(), wrap_to_pi(yaw(plan.start.yaw_rad))};
    for (models::PlanSegment& segment : plan.segments) {
      segment.control.yaw_rate_radps *= sense;
    }
  };
  const auto turn = [&](models::Rectangle& box) {
    const Eigen::Vector2d a_m = of(box.min_m.x(), box.min_m.y());
    const Eigen::Vector2d b_m = of(box.max_m.x(), box.max_m.y());
    box = {a_m.cwiseMin(b_m), a_m.cwiseMax(b_m)};
  };
  move(scene.plan);
  for (HeldPlan& plan : scene.plans) {
    move(plan);
  }
  for (Eigen::Vector3d& body_m : scene.bodies) {
    body_m.head<2>() = of(body_m.x(), body_m.y());
  }
  turn(scene.limits.fence.bounds);
  for (models::Obstacle& obstacle : scene.limits.fence.obstacles) {
    turn(obstacle.footprint);
  }
  return scene;
}

TEST(PlanCheck, IsInvariantUnderSymmetries) {
  test::Random random(35);
  std::array<int, kPlanVerdicts> counts{};
  for (int i = 0; i < 3000; ++i) {
    const Scene scene = random_scene(random);
    const PlanVerdict verdict = scene.verdict();
    ++counts[static_cast<std::size_t>(verdict)];
    const Scene mirrored = seen(
        scene, [](double x, double y) { return Eigen::Vector2d(x, -y); },
        [](double yaw) { return -yaw; }, -1.0);
    EXPECT_EQ(mirrored.verdict(), verdict) << "left and right mirrored, " << i;
    const Scene ahead = seen(
        scene, [](double x, double y) { return Eigen::Vector2d(-x, y); },
        [](double yaw) { return kPi - yaw; }, -1.0);
    EXPECT_EQ(ahead.verdict(), verdict) << "east and west mirrored, " << i;
    const Scene turned = seen(
        scene, [](double x, double y) { return Eigen::Vector2d(-y, x); },
        [](double yaw) { return yaw + 0.5 * kPi; }, 1.0);
    EXPECT_EQ(turned.verdict(), verdict) << "rotated by a quarter turn, " << i;
    const Eigen::Vector2d away_m = random.vector<2>(-50.0, 50.0);
    const Scene elsewhere = seen(
        scene,
        [&](double x, double y) -> Eigen::Vector2d { return away_m + Eigen::Vector2d(x, y); },
        [](double yaw) { return yaw; }, 1.0);
    EXPECT_EQ(elsewhere.verdict(), verdict) << "shifted, " << i;
    Scene later = scene;
    const Duration shift = from_seconds(random.uniform(-1000.0, 1000.0));
    later.now += shift;
    later.plan.start_time += shift;
    later.plans[0].start_time += shift;
    later.plans[1].start_time += shift;
    EXPECT_EQ(later.verdict(), verdict) << "shifted in time, " << i;
    Scene renamed = scene;
    std::swap(renamed.plans[0], renamed.plans[1]);
    EXPECT_EQ(renamed.verdict(), verdict) << "other order of the bodies, " << i;
  }
  for (const PlanVerdict verdict :
       {PlanVerdict::kAccepted, PlanVerdict::kInfeasible, PlanVerdict::kOutsideFence,
        PlanVerdict::kObstacle, PlanVerdict::kTeammate}) {
    EXPECT_GT(counts[static_cast<std::size_t>(verdict)], 100) << name_of(verdict);
  }
}

// A plan flown backwards with the yaw turned by π reaches the same positions at the same times.
TEST(PlanCheck, GivesTheSameVerdictForBackwardMotionWithTurnedYaw) {
  test::Random random(36);
  for (int i = 0; i < 1000; ++i) {
    const Scene scene = random_scene(random);
    Scene back = scene;
    for (HeldPlan* plan : {&back.plan, &back.plans[0], &back.plans[1]}) {
      plan->start.yaw_rad = wrap_to_pi(plan->start.yaw_rad + kPi);
      for (models::PlanSegment& segment : plan->segments) {
        segment.control.speed_mps *= -1.0;
      }
    }
    EXPECT_EQ(back.verdict(), scene.verdict()) << i;
  }
}

// ---- Limits of the shape of a plan, by bisection from both sides ----

class PlanCheckTest : public testing::Test {
 protected:
  PlanVerdict verdict(std::vector<models::PlanSegment> segments) const {
    return check_shape(held(kStart, {}, std::move(segments)), limits);
  }
  bool accepts(std::vector<models::PlanSegment> segments) const {
    return verdict(std::move(segments)) == PlanVerdict::kAccepted;
  }
  /// True if a turn at `speed_mps` with a stop after it is accepted.
  bool turns(double speed_mps, double rate_radps) const {
    return accepts({{{speed_mps, rate_radps}, 0.5, 0.0}, {{}, 0.1, 0.0}});
  }

  SafetyLimits limits = bench_limits();  // 1 m/s, 3 rad/s, 2 m/s²
};

TEST_F(PlanCheckTest, LimitsLateralAcceleration) {
  limits.lateral_max_mps2 = 1.2;
  for (const double speed_mps : {0.8, -0.8}) {
    for (const double side : {1.0, -1.0}) {
      const double most = test::last_accepted(
          0.0, 3.0, 1e-9, [&](double rate_radps) { return turns(speed_mps, side * rate_radps); });
      EXPECT_NEAR(most, 1.5, 1e-5) << speed_mps << " " << side;
    }
  }
}

TEST_F(PlanCheckTest, LimitsSpeedAndYawRate) {
  for (const double sign : {1.0, -1.0}) {
    const double rate_radps =
        test::last_accepted(0.0, 10.0, 1e-9, [&](double w) { return turns(0.1, sign * w); });
    EXPECT_NEAR(rate_radps, limits.vehicle.yaw_rate_max_radps, 1e-5);
    const double speed_mps =
        test::last_accepted(0.0, 10.0, 1e-9, [&](double v) { return turns(sign * v, 0.0); });
    EXPECT_NEAR(speed_mps, limits.vehicle.speed_max_mps, 1e-5);
  }
}

TEST_F(PlanCheckTest, LimitsDecelerationAndDuration) {
  for (const double v : {1.0, -1.0}) {
    const double brake_mps2 = test::last_accepted(1.0, 10.0, 1e-9, [&](double a) {
      return accepts({{{v, 0.0}, 1.0, a}});
    });
    EXPECT_NEAR(brake_mps2, limits.vehicle.brake_mps2, 1e-5);
    const double brake_s = test::last_accepted(1.0, 0.0, 1e-9, [&](double t_s) {
      return accepts({{{v, 0.0}, t_s, 2.0}});
    });
    EXPECT_NEAR(brake_s, 0.5, 1e-5) << "1 m/s at 2 m/s²";
    // Braking segments must be straight, because a turn while braking has no closed form.
    for (const double side : {1.0, -1.0}) {
      const double turn_radps = test::last_accepted(0.0, 1.0, 1e-9, [&](double w) {
        return accepts({{{v, side * w}, 0.5, 2.0}});
      });
      EXPECT_NEAR(turn_radps, 1e-6, 1e-8);
    }
  }
  EXPECT_EQ(verdict({{{0.0, 0.0}, 1.0, -0.1}}), PlanVerdict::kNotFinite) << "gaining speed";
}

TEST_F(PlanCheckTest, LimitsSpeedChanges) {
  for (const double sign : {1.0, -1.0}) {
    const double change_mps = test::last_accepted(0.0, 1.0, 1e-9, [&](double v) {
      return accepts({{{sign * 0.4, 0.0}, 0.5, 0.0}, {{-sign * v, 0.0}, 0.5, 0.0}, {{}, 0.1, 0.0}});
    });
    EXPECT_NEAR(change_mps, 0.6, 1e-5);
  }
}

TEST_F(PlanCheckTest, LimitsDurationAndReach) {
  const double rest_s = test::last_accepted(1.0, 1000.0, 1e-7, [&](double t_s) {
    return accepts({{{}, 0.5 * t_s, 0.0}, {{}, 0.5 * t_s, 0.0}});
  });
  EXPECT_NEAR(rest_s, 60.0, 1e-6);
  for (const double sign : {1.0, -1.0}) {
    for (const int axis : {0, 1, 2}) {
      const double far_m = test::last_accepted(0.0, 1e9, 1e-3, [&](double m) {
        HeldPlan plan = held(kStart, {}, {});
        (axis == 0 ? plan.start.x_m : axis == 1 ? plan.start.y_m : plan.height_m) = sign * m;
        return check_shape(plan, limits) == PlanVerdict::kAccepted;
      });
      EXPECT_NEAR(far_m, 1e6, 1e-2) << axis;
    }
  }
}

TEST_F(PlanCheckTest, RequiresAHeightBetweenGroundAndCeiling) {
  const auto accepts_height = [&](double height_m) {
    HeldPlan plan = held(kStart, {1.0, -1.0, 0.0}, {});
    plan.height_m = height_m;
    return check_path(plan, kStart, limits, {}) == PlanVerdict::kAccepted;
  };
  EXPECT_NEAR(test::last_accepted(1.0, -1.0, 1e-9, accepts_height), 0.0, 1e-8);
  EXPECT_NEAR(test::last_accepted(1.0, 9.0, 1e-9, accepts_height), limits.fence.ceiling_m, 1e-8);
}

// The part of the path behind the vehicle is ignored. The test finds the last time at which a
// conflict is still ahead.
TEST_F(PlanCheckTest, IgnoresTheFlownPartOfThePath) {
  limits = open_limits();
  const HeldPlan plan = held(kStart, {}, {{{1.0, 0.0}, 3.0, 0.0}, models::brake(1.0, 2.0).front()});
  const OtherCourse others[] = {{nullptr, {1.0, 0.3, 1.0}}};  // passes at 0.3 m after 1 s
  limits.plan_separation_m = 0.5;                             // the conflict ends at x = 1.4 m
  const double since_s = test::last_accepted(3.0, 0.0, 1e-7, [&](double t_s) {
    return check_path(plan, kStart + from_seconds(t_s), limits, others) == PlanVerdict::kAccepted;
  });
  EXPECT_NEAR(since_s, 1.4, 5e-6);
}

// Each other body is checked, at any position in the list.
TEST_F(PlanCheckTest, ChecksEveryBody) {
  const HeldPlan plan = held(kStart, {1.0, -1.0, 0.0}, {});
  for (std::size_t near = 0; near < 4; ++near) {
    std::vector<OtherCourse> others(4, {nullptr, {1.0, 1.5, 1.0}});
    EXPECT_EQ(check_path(plan, kStart, limits, others), PlanVerdict::kAccepted);
    others[near].position_world_m = {1.3, -1.0, 1.0};
    EXPECT_EQ(check_path(plan, kStart, limits, others), PlanVerdict::kTeammate) << near;
  }
}

// Message encoding rounds values, so a violation of up to 1e-6 m is accepted.
TEST_F(PlanCheckTest, ToleratesAViolationOfAMicrometre) {
  const auto forgiven_m = [&](const Eigen::Vector2d& edge_m, const Eigen::Vector2d& inward,
                              std::vector<OtherCourse> others = {}) {
    return test::last_accepted(-0.01, 0.01, 1e-10, [&](double beyond_m) {
      const Eigen::Vector2d p_m = edge_m - beyond_m * inward;
      const HeldPlan plan = held(kStart, {p_m.x(), p_m.y(), 0.0}, {});
      return check_path(plan, kStart, limits, others) == PlanVerdict::kAccepted;
    });
  };
  const double radius_m = limits.vehicle.radius_m;
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector2d along_x(side, 0.0);
    const Eigen::Vector2d along_y(0.0, side);
    EXPECT_NEAR(forgiven_m({side * (4.0 - radius_m), -1.0}, -along_x), 1e-6, 1e-9);
    EXPECT_NEAR(forgiven_m({2.0, side * (2.2 - radius_m)}, -along_y), 1e-6, 1e-9);
    EXPECT_NEAR(forgiven_m({side * (0.3 + radius_m), 0.65}, along_x), 1e-6, 1e-9);
    EXPECT_NEAR(forgiven_m({0.0, 0.65 + side * (0.15 + radius_m)}, along_y), 1e-6, 1e-9);
    const Eigen::Vector2d apart_m = Eigen::Vector2d(1.0, -1.0) + limits.plan_separation_m * along_x;
    EXPECT_NEAR(forgiven_m(apart_m, along_x, {{nullptr, {1.0, -1.0, 1.0}}}), 1e-6, 1e-9);
  }
}

}  // namespace
}  // namespace vantage::drivers
