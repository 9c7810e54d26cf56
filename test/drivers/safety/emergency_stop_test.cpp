// Tests fault 36 (emergency stop) outside the catalogue: during take-off and among a flood of
// messages.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr double kStopS = 0.03;  // s; one telemetry tick, one guard tick and one for rounding
constexpr std::int64_t kStranger = 99;

/// Phase of the take-off of the first vehicle in which the stop is sent.
struct Moment {
  const char* name;
  bool (*has_come)(const Vehicle& first);
};

void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }

constexpr Moment kMoments[] = {
    {"MotorsIdle", [](const Vehicle& first) { return first.is_armed; }},
    {"SpoolingUp",
     [](const Vehicle& first) {
       return first.out.state == FlightState::kHold && first.spool_s > 0.3;
     }},
    {"LeavingTheGround", [](const Vehicle& first) { return first.position_m.z() > 0.02; }},
    {"AtItsFirstLift", [](const Vehicle& first) { return first.position_m.z() > 0.17; }},
    {"Climbing", [](const Vehicle& first) { return first.position_m.z() > 0.5; }},
    {"NearlyThere", [](const Vehicle& first) { return first.position_m.z() > 0.9; }},
};

class EmergencyStopInTakeOff : public testing::TestWithParam<Moment> {
 protected:
  /// Runs until `has_come` is true or `seconds` have passed; returns whether it became true.
  bool run_until(const std::function<bool()>& has_come, double seconds) {
    for (const double end_s = bench.time_s() + seconds; bench.time_s() < end_s && !has_come();) {
      bench.tick();
    }
    return has_come();
  }
  bool any_armed() {
    const auto& all = bench.vehicles();
    return std::any_of(all.begin(), all.end(), [](const Vehicle& each) { return each.is_armed; });
  }
  void stop_and_expect_all_off() {
    bench.send_command(OperatorAction::kEmergencyStop);
    bench.run(kStopS);
    EXPECT_FALSE(any_armed());
    for (const Vehicle& each : bench.vehicles()) {
      EXPECT_EQ(each.out.state, FlightState::kKilled) << each.name;
    }
  }
  FlightBench bench{5};
};

// One vehicle lifts and two wait. All motors stop immediately, and again at a second stop. The
// first `arm` only ends the stop; the second `arm` arms the motors.
TEST_P(EmergencyStopInTakeOff, StopsEveryMotorUntilRearmed) {
  const Vehicle& first = bench.vehicle("Q1");
  bench.run(1.0);
  bench.send_command(OperatorAction::kArm);
  ASSERT_TRUE(run_until([&] { return first.is_armed; }, 3.0));
  if (std::string(GetParam().name) != "MotorsIdle") {
    bench.send_command(OperatorAction::kTakeOff);
  }
  ASSERT_TRUE(run_until([&] { return GetParam().has_come(first); }, 15.0));
  stop_and_expect_all_off();

  bool has_run = false;
  int orders_sent = 0;
  bench.run(3.0, [&] {
    has_run = has_run || any_armed();
    bench.send_command(+orders_sent % 2 == 0 ? OperatorAction::kTakeOff : OperatorAction::kFollow);
  });
  EXPECT_FALSE(has_run);
  for (const Vehicle& each : bench.vehicles()) {
    EXPECT_EQ(each.out.state, FlightState::kKilled) << each.name;
    EXPECT_EQ(each.position_m.z(), 0.0) << each.name;
  }

  bench.send_command(OperatorAction::kArm);
  bench.run(2.0);
  EXPECT_FALSE(any_armed());
  EXPECT_EQ(first.out.state, FlightState::kIdle);
  bench.send_command(OperatorAction::kArm);
  ASSERT_TRUE(run_until([&] { return first.is_armed; }, 3.0));
  stop_and_expect_all_off();
}

INSTANTIATE_TEST_SUITE_P(All, EmergencyStopInTakeOff, testing::ValuesIn(kMoments),
                         [](const auto& each) { return std::string(each.param.name); });

models::OperatorCommand stop_of(std::int64_t run_id, Time said_at) {
  models::OperatorCommand out;
  out.stamp = {said_at, run_id, 0};
  out.action = OperatorAction::kEmergencyStop;
  return out;
}

/// Delivers the `i`-th of many bad messages: unknown stations, infeasible plans, an invalid battery
/// value.
void flood(drivers::FlightGuard& guard, int i, Time now) {
  constexpr OperatorAction kWanted[] = {OperatorAction::kHeartbeat, OperatorAction::kFollow,
                                        OperatorAction::kArm, OperatorAction::kTakeOff};
  models::OperatorCommand command;
  command.stamp = {now, 1000 + i, 0};
  command.action = kWanted[i % 4];
  static_cast<void>(guard.on_command(command, now));
  models::RobotPlan plan;
  plan.stamp = {now, 2000 + i, 0};
  plan.robot = i % 2 == 0 ? "Q1" : "Q2";
  plan.trajectory.start_time = now;
  plan.trajectory.segments = {{{30.0, 0.0}, 1.0, 0.0}};
  if (i % 2 == 0) {
    static_cast<void>(guard.on_plan(plan, now));
  } else {
    guard.on_teammate_plan(plan, now);
  }
  guard.on_battery(2.0, now);
}

// The stop may come from any station and may be at any position in the queue of messages.
TEST(EmergencyStop, ActsAmongThousandsOfMessagesInOneTick) {
  constexpr int kMessages = 4000;
  for (const int place : {0, kMessages / 2, kMessages - 1}) {
    SCOPED_TRACE(place);
    FlightBench bench(5);
    bench.fly_up(6.4);
    Vehicle& q1 = bench.vehicle("Q1");
    ASSERT_EQ(q1.out.state, FlightState::kFollow);
    for (int i = 0; i < kMessages; ++i) {
      if (i == place) {
        EXPECT_EQ(q1.guard->on_command(stop_of(kStranger, bench.now()), bench.now()),
                  drivers::CommandVerdict::kObeyed);
      }
      flood(*q1.guard, i, bench.now());
    }
    bench.tick();
    EXPECT_EQ(q1.out.state, FlightState::kKilled);
    EXPECT_FALSE(q1.is_armed);
    int more = kMessages;
    bench.run(2.0, [&] { flood(*q1.guard, ++more, bench.now()); });
    EXPECT_EQ(q1.out.state, FlightState::kKilled) << "messages of unknown senders change nothing";
    EXPECT_FALSE(q1.is_armed);
  }
}

// The process was stalled for 0.4 s while the stop was queued; its first tick after the stall must
// obey the stop.
TEST(EmergencyStop, ActsAtTheFirstTickAfterAStall) {
  FlightBench bench(5);
  bench.fly_up(6.4);
  Vehicle& q1 = bench.vehicle("Q1");
  const models::OperatorCommand stop = stop_of(kStranger, bench.now());
  bench.run(0.4, [&] { q1.knobs.is_stalled = true; });
  ASSERT_TRUE(q1.is_armed);
  static_cast<void>(q1.guard->on_command(stop, bench.now()));
  bench.tick();
  EXPECT_EQ(q1.out.state, FlightState::kKilled);
  EXPECT_FALSE(q1.is_armed);
}

}  // namespace
}  // namespace vantage::test
