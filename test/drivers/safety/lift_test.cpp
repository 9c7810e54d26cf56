// The order in which vehicles lift, and the first lift, tested without a simulated flight.

#include "drivers/safety/lift.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kClimbMps = 0.3;
constexpr double kTurnDelayS = 0.15;  // s; additional wait per position in the scenario

Time after(double t_s) { return kStart + from_seconds(t_s); }

scenario::Scenario team(const std::vector<std::string>& names) {
  scenario::Scenario out;
  for (const std::string& name : names) {
    out.robots.emplace_back().name = name;
  }
  return out;
}

OtherBody body(int robot, double height_m, double climb_mps = 0.0) {
  OtherBody out;
  out.robot = robot;
  out.position_world_m = {0.7 * robot, -0.4, height_m};
  out.velocity_world_mps.z() = climb_mps;
  return out;
}

/// Returns the queue of Q1 (of three robots), updated with the bodies at rest, `rest`, and 1 s
/// later with `then`.
LiftQueue seen(const std::vector<OtherBody>& rest, const std::vector<OtherBody>& then) {
  LiftQueue queue(team({"Q1", "Q2", "Q3"}), "Q1");
  queue.update(rest, SafetyLimits{}, kStart);
  queue.update(then, SafetyLimits{}, after(1.0));
  return queue;
}

// Vehicles lift in the order in which their take-off orders arrived. A repeated order keeps the
// position; orders for several vehicles at once are sorted by name. A vehicle leaves the queue when
// mocap shows that it has risen.
TEST(LiftQueue, OrdersByCommandThenByName) {
  const SafetyLimits limits;
  const std::vector<std::string> names = {"Q3", "Q1", "Q4", "Q2"};
  test::Random random(31);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<LiftQueue> queues;
    std::vector<OtherBody> bodies;
    for (std::size_t i = 0; i < names.size(); ++i) {
      queues.emplace_back(team(names), names[i]);
      bodies.push_back(body(static_cast<int>(i), random.uniform(0.0, 0.6)));
    }
    std::vector<std::string> heard;
    for (int order = random.integer(1, 5); order > 0; --order) {
      std::vector<std::string> told = {names[static_cast<std::size_t>(random.integer(0, 3))]};
      const bool is_for_all = random.integer(0, 4) == 0;
      if (is_for_all) {
        told = names;
        std::sort(told.begin(), told.end());
      }
      for (LiftQueue& queue : queues) {
        queue.on_take_off(is_for_all ? "" : told.front());
      }
      for (const std::string& name : told) {
        if (std::find(heard.begin(), heard.end(), name) == heard.end()) {
          heard.push_back(name);
        }
      }
    }
    double t_s = 0.0;
    std::vector<bool> is_gone(names.size(), false);
    for (; !heard.empty(); heard.erase(heard.begin())) {
      for (const double later_s : {0.0, 1.0}) {  // s; 1 s exceeds every additional wait
        for (LiftQueue& queue : queues) {
          queue.update(bodies, limits, after(t_s + later_s));
        }
      }
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (!is_gone[i]) {
          EXPECT_EQ(queues[i].is_blocked(), names[i] != heard.front()) << names[i];
        }
      }
      const auto first = static_cast<std::size_t>(
          std::find(names.begin(), names.end(), heard.front()) - names.begin());
      queues[first].forget_own();
      is_gone[first] = true;
      bodies[first].position_world_m.z() += limits.lift_done_m + 0.01;
      t_s += 2.0;
    }
    for (const double later_s : {0.0, 1.0}) {
      for (LiftQueue& queue : queues) {
        queue.update(bodies, limits, after(t_s + later_s));
      }
    }
    for (const LiftQueue& queue : queues) {
      EXPECT_FALSE(queue.is_blocked());
    }
  }
}

// A report of lifting blocks other lifts for 0.5 s plus the vehicle's additional wait. The
// vehicle's own reports and reports of unknown vehicles are ignored.
TEST(LiftQueue, WaitsTheStatedTimeAfterAReport) {
  const std::vector<std::string> names = {"Q1", "Q2", "Q3"};
  for (std::size_t own = 0; own < names.size(); ++own) {
    LiftQueue queue(team(names), names[own]);
    for (const double begin_s : {0.0, 10.0}) {  // repeated later with the same queue
      queue.on_lifting(names[own], after(begin_s));
      queue.on_lifting("Q9", after(begin_s));
      queue.update({}, SafetyLimits{}, after(begin_s));
      EXPECT_FALSE(queue.is_blocked());
      queue.on_lifting(names[(own + 1) % 3], after(begin_s));
      int ticks = 0;
      do {
        ++ticks;
        queue.update({}, SafetyLimits{}, after(begin_s + 0.01 * ticks));
      } while (queue.is_blocked() && ticks < 300);
      EXPECT_NEAR(0.01 * ticks, 0.5 + kTurnDelayS * static_cast<double>(own + 1), 0.021);
    }
  }
}

// A monotonic clock may start at 0. A report that was never received must not count as received at
// time 0.
TEST(LiftQueue, IsNotBlockedAtClockZero) {
  LiftQueue queue(team({"Q1", "Q2"}), "Q1");
  for (const double t_s : {0.2, 0.3, 0.4}) {
    queue.update({}, SafetyLimits{}, Time{} + from_seconds(t_s));
    EXPECT_FALSE(queue.is_blocked()) << t_s;
  }
}

// The turn of the first vehicle in the queue begins when it is first seen there. The queue is
// static so that its memory starts as zero.
TEST(LiftQueue, WaitsForThePredecessorFromTheFirstTick) {
  static LiftQueue queue(team({"Q1", "Q2"}), "Q2");
  queue.on_take_off("Q1");
  for (const double t_s : {0.0, 1.0, 2.0}) {
    queue.update({}, SafetyLimits{}, after(t_s));
    EXPECT_TRUE(queue.is_blocked()) << t_s;
  }
}

TEST(LiftQueue, IsNotBlockedWithoutOtherRobots) {
  LiftQueue queue(team({}), "Q1");
  queue.on_take_off("");
  queue.forget_own();
  queue.begin_own();
  queue.update({}, SafetyLimits{}, kStart);
  EXPECT_FALSE(queue.is_blocked());
  EXPECT_EQ(queue.other_risen_m(), 0.0);
}

// A body other than our own counts as lifting if it is 0.02 m to 0.5 m above its rest height and
// climbs faster than 0.05 m/s. The rest height may be the floor, a table or a pit.
TEST(LiftQueue, TreatsALowClimbingBodyAsLifting) {
  for (const double rest_m : {0.0, 0.4, -0.3}) {
    for (const double risen_m : {0.0, 0.01, 0.019, 0.021, 0.1, 0.3, 0.49, 0.51, 2.0}) {
      for (const double climb_mps : {-0.5, 0.0, 0.02, 0.049, 0.051, 0.08, 1.0}) {
        for (int robot = 0; robot < 3; ++robot) {
          OtherBody then = body(robot, rest_m + risen_m, climb_mps);
          then.velocity_world_mps.y() = climb_mps > 0.05 ? 0.0 : 1.0;
          const LiftQueue queue = seen({body(robot, rest_m)}, {then});
          const bool is_lifting = climb_mps > 0.05 && risen_m > 0.02 && risen_m < 0.5;
          EXPECT_EQ(queue.is_blocked(), robot != 0 && is_lifting)
              << rest_m << " " << risen_m << " " << climb_mps << " " << robot;
        }
      }
    }
  }
}

TEST(LiftQueue, DetectsALiftRegardlessOfOtherBodies) {
  for (const double far_up_m : {0.0, 0.01, 0.8}) {
    for (const int lifting : {1, 2}) {
      const int other = 3 - lifting;
      EXPECT_TRUE(seen({body(1, 0.2), body(2, 0.2)},
                       {body(lifting, 0.3, kClimbMps), body(other, 0.2 + far_up_m, kClimbMps)})
                      .is_blocked());
    }
  }
}

TEST(LiftQueue, UsesTheLowestHeightAsGroundHeight) {
  LiftQueue queue(team({"Q1", "Q2"}), "Q1");
  double t_s = 0.0;
  const auto takes = [&](double height_m, double climb_mps) {
    const OtherBody other = body(1, height_m, climb_mps);
    queue.update({&other, 1}, SafetyLimits{}, after(t_s += 1.0));
    return queue.is_blocked();
  };
  EXPECT_FALSE(takes(0.4, kClimbMps));
  EXPECT_TRUE(takes(0.43, kClimbMps));
  EXPECT_FALSE(takes(0.2, 0.0));
  EXPECT_TRUE(takes(0.25, kClimbMps));
  EXPECT_FALSE(takes(0.71, kClimbMps)) << "0.51 m above the lowest";
  EXPECT_TRUE(takes(0.69, kClimbMps));
}

TEST(LiftQueue, UsesPosesUpToTheMaximumAge) {
  const SafetyLimits limits;
  for (const double age_s : {0.0, limits.pose_age_hold_s - 0.01, limits.pose_age_hold_s + 0.01}) {
    OtherBody then = body(1, 0.1, kClimbMps);
    then.age_s = age_s;
    EXPECT_EQ(seen({body(1, 0.0)}, {then}).is_blocked(), age_s < limits.pose_age_hold_s) << age_s;
  }
}

// other_risen_m() is the largest rise of another body since this vehicle began its lift. Only
// bodies that climb and had not risen before count. A second lift starts from new heights. The
// result is 0 when no body climbs.
TEST(LiftQueue, MeasuresTheRiseOfAnotherBody) {
  const SafetyLimits limits;
  test::Random random(32);
  for (int trial = 0; trial < 500; ++trial) {
    LiftQueue queue(team({"Q1", "Q2", "Q3", "Q4"}), "Q2");
    std::vector<OtherBody> bodies;
    std::vector<double> rest_m, begun_m;
    const auto look = [&] { queue.update(bodies, limits, kStart); };
    for (int i = 0; i < 4; ++i) {
      rest_m.push_back(random.uniform(0.0, 0.6));
      bodies.push_back(body(i, rest_m.back()));
    }
    look();
    for (int time = 0; time < 2; ++time) {
      begun_m.clear();
      for (std::size_t i = 0; i < 4; ++i) {
        begun_m.push_back(rest_m[i] +
                          (random.coin() ? random.uniform(0.0, 0.09) : random.uniform(0.11, 1.0)));
        bodies[i].position_world_m.z() = begun_m[i];
      }
      look();
      queue.begin_own();
      double farthest_m = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        const double risen_m = random.uniform(0.0, 0.3);
        const bool climbs = random.coin();
        bodies[i].position_world_m.z() = begun_m[i] + risen_m;
        bodies[i].velocity_world_mps.z() = climbs ? kClimbMps : 0.0;
        if (i != 1 && climbs && begun_m[i] - rest_m[i] < limits.lift_risen_m) {
          farthest_m = std::max(farthest_m, risen_m);
        }
      }
      look();
      EXPECT_NEAR(queue.other_risen_m(), farthest_m, 1e-12);
      for (OtherBody& other : bodies) {
        other.velocity_world_mps.z() = 0.0;
      }
      look();
      EXPECT_EQ(queue.other_risen_m(), 0.0);
    }
  }
}

TEST(LiftQueue, MeasuresARiseFromTheFirstPose) {
  LiftQueue queue(team({"Q1", "Q2"}), "Q1");
  queue.begin_own();
  for (const double height_m : {0.4, 0.43, 0.48}) {
    const OtherBody other = body(1, height_m, kClimbMps);
    queue.update({&other, 1}, SafetyLimits{}, kStart);
    EXPECT_NEAR(queue.other_risen_m(), height_m - 0.4, 1e-12);
  }
}

// A vehicle waits for its predecessor in the queue up to a time limit, which is longer once the
// predecessor has risen, because then its identity is verified. A predecessor on a table rises from
// the table. The sequence is repeated with the same queue.
TEST(LiftQueue, WaitsForThePredecessorUpToTheTimeLimit) {
  const SafetyLimits limits;
  for (const double rest_m : {0.0, 0.4, -0.3}) {
    LiftQueue queue(team({"Q1", "Q2"}), "Q2");
    double t_s = 0.0;
    for (const double risen_m : {0.0, 0.09, 0.11, 0.29, 0.0}) {
      OtherBody first = body(0, rest_m);
      queue.update({&first, 1}, limits, after(t_s));
      queue.forget_own();
      queue.on_take_off("Q1");
      queue.on_take_off("Q2");
      first = body(0, rest_m + risen_m);
      int ticks = 0;
      do {
        ++ticks;
        queue.update({&first, 1}, limits, after(t_s + 0.02 * ticks));
      } while (queue.is_blocked() && ticks < 2000);
      const double proof_s = risen_m > limits.lift_risen_m ? limits.lift_proof_s : 0.0;
      EXPECT_NEAR(0.02 * ticks, limits.lift_wait_s + 6.0 + proof_s + 2.0 * kTurnDelayS, 0.1)
          << rest_m << " " << risen_m;
      t_s += 0.02 * ticks;
    }
  }
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
          room.rest_m.head<2>() + apart_m + 0.3 * apart_m.normalized();  // a step cannot reach it
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
      EXPECT_EQ(no_rise_s(0.0, 5.5), 0.0) << "it had risen";
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
    const Setpoint asked = f.course.planned_at(kStart);
    if (is_proven_first) {
      EXPECT_TRUE(step(asked.position_world_m, asked.yaw_rad));
    } else {
      f.own.end();
    }
    const Eigen::Vector3d elsewhere_m(4.0, 4.0, 1.0);
    f.course.hover(elsewhere_m, 1.5, kStart);
    EXPECT_FALSE(step(asked.position_world_m, asked.yaw_rad));
    EXPECT_FALSE(f.own.is_under_way());
    EXPECT_EQ(f.course.planned_at(kStart).position_world_m, elsewhere_m);
    // Begins a second lift on the ground.
    f.own.begin(lift(f.rest, f.rest_m), {}, f.limits, kStart);
    EXPECT_FALSE(step(asked.position_world_m - Eigen::Vector3d(0.0, 0.0, 0.2), asked.yaw_rad));
    EXPECT_EQ(f.own.phase(), Lift::Phase::kRising);
    EXPECT_EQ(f.course.planned_at(kStart).position_world_m, elsewhere_m);
  }
}

// Compared with the nearest of ten thousand points of the path. The body is also beyond both ends
// and at any height. Before and after the lift the distance is 0.
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
