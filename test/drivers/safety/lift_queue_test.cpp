// Tests the order in which vehicles lift, without a simulated flight.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/safety/lift.hpp"
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
    std::vector<std::string> queued;
    for (int order = random.integer(1, 5); order > 0; --order) {
      std::vector<std::string> ordered = {names[static_cast<std::size_t>(random.integer(0, 3))]};
      const bool is_for_all = random.integer(0, 4) == 0;
      if (is_for_all) {
        ordered = names;
        std::sort(ordered.begin(), ordered.end());
      }
      for (LiftQueue& queue : queues) {
        queue.on_take_off(is_for_all ? "" : ordered.front());
      }
      for (const std::string& name : ordered) {
        if (std::find(queued.begin(), queued.end(), name) == queued.end()) {
          queued.push_back(name);
        }
      }
    }
    double t_s = 0.0;
    std::vector<bool> is_gone(names.size(), false);
    for (; !queued.empty(); queued.erase(queued.begin())) {
      for (const double later_s : {0.0, 1.0}) {  // s; 1 s exceeds every additional wait
        for (LiftQueue& queue : queues) {
          queue.update(bodies, limits, after(t_s + later_s));
        }
      }
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (!is_gone[i]) {
          EXPECT_EQ(queues[i].is_blocked(), names[i] != queued.front()) << names[i];
        }
      }
      const auto first = static_cast<std::size_t>(
          std::find(names.begin(), names.end(), queued.front()) - names.begin());
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
// vehicle's own reports and those of unknown vehicles are ignored.
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

// Real autopilots take up to 30 s to arm and several seconds to spool up. By then the order of the
// commands is forgotten and mocap does not show a rise yet, so vehicles report their own lift.
TEST(LiftQueue, WaitsForReportedLiftsThenOrdersByName) {
  const SafetyLimits limits;
  const scenario::Scenario scenario = team({"Q1", "Q2", "Q3"});
  LiftQueue second(scenario, "Q2");
  LiftQueue third(scenario, "Q3");
  const auto look = [&](double at_s) {
    second.update({}, limits, after(at_s));
    third.update({}, limits, after(at_s));
  };
  for (const double begin_s : {0.0, 20.0}) {  // repeated later with the same queues
    look(begin_s);
    EXPECT_FALSE(second.is_blocked());
    for (int i = 0; i <= 40; ++i) {
      second.on_lifting("Q1", after(begin_s + 0.1 * i));
      third.on_lifting("Q1", after(begin_s + 0.1 * i));
      look(begin_s + 0.1 * i);
      EXPECT_TRUE(second.is_blocked());
      EXPECT_TRUE(third.is_blocked());
    }
    double second_s = 0.0;
    double third_s = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const double at_s = begin_s + 4.0 + 0.02 * i;
      look(at_s);
      second_s = second_s > 0.0 || second.is_blocked() ? second_s : at_s;
      third_s = third_s > 0.0 || third.is_blocked() ? third_s : at_s;
    }
    EXPECT_GT(second_s, begin_s + 4.4);
    EXPECT_GT(third_s, second_s + 0.1) << "the third must receive the report of the second";
    EXPECT_LT(third_s, begin_s + 5.5);
  }
}

// The motors of two vehicles start at the same instant.
TEST(LiftQueue, StaggersSimultaneousStarts) {
  double begun_s[3] = {};
  const char* const names[] = {"Q1", "Q2", "Q3"};
  for (int i = 0; i < 3; ++i) {
    LiftQueue queue(team({"Q1", "Q2", "Q3"}), names[i]);
    queue.begin_turn(kStart);
    for (int k = 1; k < 100 && begun_s[i] == 0.0; ++k) {
      queue.update({}, SafetyLimits{}, after(0.02 * k));
      begun_s[i] = queue.is_blocked() ? 0.0 : 0.02 * k;
    }
  }
  EXPECT_GT(begun_s[0], 0.0);
  EXPECT_GT(begun_s[1], begun_s[0] + 0.1);
  EXPECT_GT(begun_s[2], begun_s[1] + 0.1);
}

}  // namespace
}  // namespace vantage::drivers
