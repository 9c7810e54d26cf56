// Tests the first lift without a simulated flight.

#include "drivers/safety/lift.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

Time after(double t_s) { return kStart + from_seconds(t_s); }

// The test step and turn of a lift are recognised only in the commanded direction and beyond 0.3 of
// the commanded amount, for any ground position and yaw.
TEST(Lift, IsVerifiedByTheCommandedStepAndTurn) {
  const SafetyLimits limits;
  const auto proves = [&](const Pose2& rest, double x_share, double y_share, double turn_share) {
    Lift own;
    Course course(0.25);
    own.begin(lift(rest, 0.1), {}, limits, kStart);
    EXPECT_DOUBLE_EQ(own.rest_m(), 0.1);
    EXPECT_DOUBLE_EQ(own.height_m(), 0.1 + limits.lift_height_m);
    EXPECT_EQ(own.phase(), Lift::Phase::kRising);
    const Eigen::Vector3d hover_m(rest.x_m, rest.y_m, own.height_m());
    EXPECT_FALSE(own.step(hover_m, rest.yaw_rad, course, limits, kStart));
    EXPECT_EQ(own.phase(), Lift::Phase::kProving);
    const Setpoint planned = course.planned_at(kStart);
    Eigen::Vector3d gone_m = planned.position_world_m - hover_m;
    EXPECT_NEAR(std::abs(gone_m.x()), limits.lift_step_m, 1e-12);
    EXPECT_NEAR(std::abs(gone_m.y()), limits.lift_step_m, 1e-12);
    EXPECT_NEAR(wrap_to_pi(planned.yaw_rad - rest.yaw_rad), limits.lift_turn_rad, 1e-12);
    gone_m = gone_m.cwiseProduct(Eigen::Vector3d(x_share, y_share, 0.0));
    const double yaw_rad = wrap_to_pi(rest.yaw_rad + turn_share * limits.lift_turn_rad);
    const bool is_proven = own.step(hover_m + gone_m, yaw_rad, course, limits, kStart);
    EXPECT_EQ(own.is_under_way(), !is_proven);
    const Setpoint then =
        course.planned_at(kStart);  // the ground position if verified, otherwise the step
    const Eigen::Vector2d back_m =
        is_proven ? rest.position_m() : Eigen::Vector2d(planned.position_world_m.head<2>());
    EXPECT_LT((then.position_world_m.head<2>() - back_m).norm(), 1e-12);
    const double back_rad = is_proven ? rest.yaw_rad : planned.yaw_rad;
    EXPECT_NEAR(wrap_to_pi(then.yaw_rad - back_rad), 0.0, 1e-12);
    return is_proven;
  };
  for (const Pose2& rest : {Pose2{0.0, 0.0, 0.0}, Pose2{-1.0, 0.5, 3.1}, Pose2{1.0, -0.5, -2.0}}) {
    for (const double x_share : {-1.0, -0.31, 0.29, 0.31, 1.0}) {
      for (const double y_share : {-1.0, 0.29, 0.31, 1.0}) {
        for (const double turn_share : {-1.0, 0.29, 0.31, 1.0}) {
          EXPECT_EQ(proves(rest, x_share, y_share, turn_share),
                    std::min({x_share, y_share, turn_share}) > 0.3)
              << x_share << " " << y_share << " " << turn_share;
        }
      }
    }
  }
}

// The first hover must not be higher than the commanded take-off height.
TEST(Lift, StaysBelowTheTakeOffHeight) {
  const SafetyLimits limits;
  Lift own;
  own.begin(lift(Pose2{0.3, -0.2, 0.0}, limits.take_off_height_m - 0.05), {}, limits, Time{});
  EXPECT_DOUBLE_EQ(own.height_m(), limits.take_off_height_m);
}

struct Room {
  SafetyLimits limits;
  std::vector<OtherBody> others;
  Eigen::Vector3d rest_m;
  /// Returns the free distance around `p_m`: the minimum over walls, boxes and edges of bodies.
  [[nodiscard]] double around_m(const Eigen::Vector2d& p_m) const {
    const models::Rectangle& walls = limits.fence.bounds;
    double out_m = std::min((p_m - walls.min_m).minCoeff(), (walls.max_m - p_m).minCoeff());
    for (const models::Obstacle& box : limits.fence.obstacles) {
      const Eigen::Vector2d nearest_m =
          p_m.cwiseMax(box.footprint.min_m).cwiseMin(box.footprint.max_m);
      out_m = std::min(out_m, (p_m - nearest_m).norm());
    }
    for (const OtherBody& other : others) {
      const Eigen::Vector2d apart_m = p_m - other.position_world_m.head<2>();
      out_m = std::min(out_m, apart_m.norm() - limits.vehicle.radius_m);
    }
    return out_m;
  }
};

/// Returns the horizontal step that a first lift commands in `room`, m.
Eigen::Vector2d commanded_step_m(const Room& room) {
  Lift own;
  Course course(0.25);
  own.begin(lift({room.rest_m.x(), room.rest_m.y(), 0.0}, room.rest_m.z()), room.others,
            room.limits, kStart);
  const Eigen::Vector3d hover_m(room.rest_m.x(), room.rest_m.y(), own.height_m());
  EXPECT_FALSE(own.step(hover_m, 0.0, course, room.limits, kStart));
  return (course.planned_at(kStart).position_world_m - room.rest_m).head<2>();
}

// The test step goes along both axes, to the diagonal position with the most free space.
TEST(Lift, StepsToTheDiagonalWithTheMostFreeSpace) {
  const Eigen::Vector2d diagonals[] = {{1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}};
  for (const Eigen::Vector2d& free : diagonals) {
    SCOPED_TRACE(free.transpose());
    Room room;
    room.limits.vehicle.radius_m = 0.15;
    room.limits.fence.bounds = {{-9.0, -9.0}, {9.0, 9.0}};
    room.rest_m = {1.5, -0.9, 0.0};
    const auto add_body = [&room](const Eigen::Vector2d& off_m) {
      room.others.emplace_back().position_world_m =
          room.rest_m + Eigen::Vector3d(off_m.x(), off_m.y(), 0.0);
    };
    for (const Eigen::Vector2d& taken : diagonals) {
      if (taken != free) {
        add_body(0.15 * taken);
      }
    }
    EXPECT_TRUE(test::is_near(commanded_step_m(room), 0.15 * free, 1e-12));
    // A wall at 0.65 m leaves more free space than the centre of another body at 0.74 m.
    models::Rectangle& walls = room.limits.fence.bounds;
    (free.x() > 0.0 ? walls.max_m : walls.min_m).x() = room.rest_m.x() + 0.8 * free.x();
    room.others.clear();
    add_body(-0.5 * free);
    EXPECT_TRUE(test::is_near(commanded_step_m(room), 0.15 * free, 1e-12));
  }
}

// The step has the length lift_step_m along each axis. Walls, boxes and bodies each determine the
// result in some trials.
TEST(Lift, StepsToTheFreestDiagonalAmongRandomBodies) {
  test::Random random(33);
  int least[3] = {};
  for (int trial = 0; trial < 500; ++trial) {
    Room room;
    room.limits.vehicle.radius_m = 0.2;
    room.rest_m = random.vector<3>(-1.0, 1.0);
    room.limits.fence.bounds = {random.vector<2>(-4.0, -1.6), random.vector<2>(1.6, 4.0)};
    for (int i = random.integer(0, 2); i > 0; --i) {
      const Eigen::Vector2d apart_m = random.vector<2>(-1.0, 1.0);
      const Eigen::Vector2d corner_m =
          room.rest_m.head<2>() + apart_m + 0.3 * apart_m.normalized();  // too far away for a step
      room.limits.fence.obstacles.push_back({{corner_m, corner_m}, 1.0});
    }
    for (int i = random.integer(0, 2); i > 0; --i) {
      room.others.emplace_back().position_world_m = random.vector<3>(-3.0, 3.0);
    }
    const Eigen::Vector2d step_m = commanded_step_m(room);
    const Eigen::Vector2d goal_m = room.rest_m.head<2>() + step_m;
    EXPECT_TRUE(test::is_near(step_m.cwiseAbs(), Eigen::Vector2d::Constant(room.limits.lift_step_m),
                              1e-12));
    for (const double x : {1.0, -1.0}) {
      for (const double y : {1.0, -1.0}) {
        const Eigen::Vector2d other_m =
            room.rest_m.head<2>() + step_m.cwiseProduct(Eigen::Vector2d(x, y));
        EXPECT_LE(room.around_m(other_m), room.around_m(goal_m) + 1e-12) << trial;
      }
    }
    Room fewer = room;
    const double most_m = room.around_m(goal_m);
    fewer.others.clear();
    const bool is_by_bodies = most_m < fewer.around_m(goal_m);
    fewer.limits.fence.obstacles.clear();
    const bool is_by_walls = most_m >= fewer.around_m(goal_m);
    ++least[is_by_bodies ? 0 : is_by_walls ? 1 : 2];
  }
  EXPECT_GT(*std::min_element(std::begin(least), std::end(least)), 50);
}

constexpr double kProofHeightToleranceM = 0.06;  // m; verification begins this far below hover

/// A vehicle commanded to climb from its ground position, far from all walls.
struct Flight {
  SafetyLimits limits;
  Lift own;
  Course course{0.25};
  Pose2 rest;
  double rest_m;
  Flight(const Pose2& stood, double height_m) : rest(stood), rest_m(height_m) {
    limits.fence.bounds = {{-9.0, -9.0}, {9.0, 9.0}};
    limits.take_off_height_m = 2.0;
    own.begin(lift(rest, rest_m), {}, limits, kStart);
  }
  [[nodiscard]] Eigen::Vector3d risen(double by_m) const {
    return {rest.x_m, rest.y_m, rest_m + by_m};
  }
};

TEST(Lift, MeasuresTheTimeWithoutRiseAndWithoutTestStep) {
  for (const Pose2& rest : {Pose2{0.0, 0.0, 0.0}, Pose2{1.0, -2.0, 2.0}, Pose2{-1.0, 2.0, -2.0}}) {
    for (const double rest_m : {0.0, 0.4, -0.3}) {
      Flight f(rest, rest_m);
      const double rises_m = f.limits.lift_risen_m;
      const auto no_rise_s = [&](double by_m, double t_s) {
        return f.own.no_rise_s(f.risen(by_m), f.limits, after(t_s));
      };
      EXPECT_EQ(Lift{}.no_rise_s(f.risen(0.0), f.limits, after(1.0)), 0.0);
      EXPECT_DOUBLE_EQ(no_rise_s(0.0, 2.0), 2.0);
      EXPECT_DOUBLE_EQ(no_rise_s(rises_m - 0.01, 3.0), 3.0);
      EXPECT_EQ(no_rise_s(rises_m + 0.01, 3.0), 0.0);
      const double enough_m = f.limits.lift_height_m - kProofHeightToleranceM;
      EXPECT_FALSE(
          f.own.step(f.risen(enough_m - 0.001), rest.yaw_rad, f.course, f.limits, after(3.0)));
      EXPECT_EQ(f.own.phase(), Lift::Phase::kRising);
      EXPECT_EQ(f.own.proof_pending_s(after(3.5)), 0.0);
      EXPECT_FALSE(
          f.own.step(f.risen(enough_m + 0.001), rest.yaw_rad, f.course, f.limits, after(4.0)));
      EXPECT_EQ(f.own.phase(), Lift::Phase::kProving);
      EXPECT_DOUBLE_EQ(f.own.proof_pending_s(after(5.5)), 1.5);
      EXPECT_EQ(no_rise_s(0.0, 5.5), 0.0) << "the vehicle had risen";
      f.own.end();
      EXPECT_EQ(f.own.proof_pending_s(after(5.5)), 0.0);
      EXPECT_EQ(no_rise_s(0.0, 5.5), 0.0);
    }
  }
}

// The identity can only be verified in the hover, once: not during the climb, after the
// verification or after end().
TEST(Lift, IsVerifiedOnlyInTheHover) {
  for (const bool is_proven_first : {true, false}) {
    Flight f({1.0, -2.0, 0.5}, 0.1);
    const auto step = [&](const Eigen::Vector3d& at_m, double yaw_rad) {
      return f.own.step(at_m, yaw_rad, f.course, f.limits, kStart);
    };
    EXPECT_FALSE(step(f.risen(0.2), 0.5));
    const Setpoint planned = f.course.planned_at(kStart);
    if (is_proven_first) {
      EXPECT_TRUE(step(planned.position_world_m, planned.yaw_rad));
    } else {
      f.own.end();
    }
    const Eigen::Vector3d elsewhere_m(4.0, 4.0, 1.0);
    f.course.hover(elsewhere_m, 1.5, kStart);
    EXPECT_FALSE(step(planned.position_world_m, planned.yaw_rad));
    EXPECT_FALSE(f.own.is_under_way());
    EXPECT_EQ(f.course.planned_at(kStart).position_world_m, elsewhere_m);
    // Begins a second lift on the ground.
    f.own.begin(lift(f.rest, f.rest_m), {}, f.limits, kStart);
    EXPECT_FALSE(step(planned.position_world_m - Eigen::Vector3d(0.0, 0.0, 0.2), planned.yaw_rad));
    EXPECT_EQ(f.own.phase(), Lift::Phase::kRising);
    EXPECT_EQ(f.course.planned_at(kStart).position_world_m, elsewhere_m);
  }
}

// Compares the distance with that of the nearest of ten thousand points of the path. The body is
// also beyond both ends of the path and at any height. Before and after the lift the distance is 0.
TEST(Lift, MeasuresItsDistanceFromThePath) {
  Flight f({1.0, -2.0, 0.5}, 0.1);
  EXPECT_EQ(Lift{}.deviation_m({3.0, 3.0, 3.0}), 0.0);
  EXPECT_FALSE(f.own.step(f.risen(0.2), 0.5, f.course, f.limits, kStart));
  const Eigen::Vector2d to_m = f.course.planned_at(kStart).position_world_m.head<2>();
  test::Random random(34);
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::Vector3d here_m = f.risen(0.0) + random.vector<3>(-0.5, 0.5);
    double least_m = 9.0;
    for (int i = 0; i <= 10'000; ++i) {
      const Eigen::Vector2d on_way_m =
          f.rest.position_m() + 1e-4 * i * (to_m - f.rest.position_m());
      least_m = std::min(least_m, (here_m.head<2>() - on_way_m).norm());
    }
    EXPECT_NEAR(f.own.deviation_m(here_m), least_m, 2e-5);
  }
  EXPECT_NEAR(f.own.deviation_m({to_m.x(), to_m.y(), 7.0}), 0.0, 1e-12);
  f.own.end();
  EXPECT_EQ(f.own.deviation_m({3.0, 3.0, 3.0}), 0.0);
}

}  // namespace
}  // namespace vantage::drivers
