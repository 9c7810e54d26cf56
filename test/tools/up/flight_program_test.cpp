#include "tools/up/flight_program.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// A vehicle that obeys orders like a vehicle with a driver: it arms on request and takes off once
/// its motors run.
struct Vehicle {
  std::string name = "Q1";
  FlightState state = FlightState::kIdle;
  bool wants_armed = false;
  Time armed_at{};
  Duration arming = std::chrono::seconds(3);
  Duration climbing = std::chrono::seconds(4);
  Time lifted_at{};
  Time landed_at = Time::max();

  void obey(OperatorAction action, Time now) {
    const bool is_armed = wants_armed && now - armed_at > arming;
    if (state == FlightState::kIdle && action == OperatorAction::kArm && !wants_armed) {
      wants_armed = true;
      armed_at = now;
    } else if (state == FlightState::kIdle && action == OperatorAction::kTakeOff && is_armed) {
      state = FlightState::kHold;
      lifted_at = now;
    } else if (state == FlightState::kHold && action == OperatorAction::kFollow) {
      state = FlightState::kFollow;
    } else if (action == OperatorAction::kLand && state != FlightState::kIdle &&
               state != FlightState::kKilled) {
      landed_at = state == FlightState::kLand ? landed_at : now + std::chrono::seconds(5);
      state = FlightState::kLand;
    }
  }
  [[nodiscard]] models::VehicleStatus status(Time now) {
    if (state == FlightState::kLand && now >= landed_at) {
      state = FlightState::kIdle;
    }
    models::VehicleStatus out;
    out.stamp.time = now;
    out.robot = name;
    out.state = state;
    if (state == FlightState::kHold && now - lifted_at < climbing) {
      out.reasons.emplace_back("waiting for take-off height");
    }
    return out;
  }
};

struct Trial {
  std::vector<Vehicle> vehicles;
  FlightProgram program;
  Time now = kStart;
  std::vector<FlightProgram::Order> orders;

  explicit Trial(const std::vector<std::string>& names) : program(names) {
    for (const std::string& name : names) {
      vehicles.emplace_back().name = name;
    }
  }
  void run(double seconds) {
    const Time end = now + from_seconds(seconds);
    for (; now < end; now += Duration{100'000}) {
      for (Vehicle& vehicle : vehicles) {
        program.on_status(vehicle.status(now));
      }
      for (const FlightProgram::Order& order : program.due(now)) {
        orders.push_back(order);
        for (Vehicle& vehicle : vehicles) {
          if (vehicle.name == order.robot) {
            vehicle.obey(order.action, now);
          }
        }
      }
    }
  }
  [[nodiscard]] std::int64_t count(OperatorAction action, const std::string& robot) const {
    return std::count_if(orders.begin(), orders.end(), [&](const FlightProgram::Order& order) {
      return order.action == action && order.robot == robot;
    });
  }
};

TEST(FlightProgram, TakesOffAndLandsEveryVehicle) {
  Trial trial({"Q1", "Q2"});
  trial.vehicles[1].arming = std::chrono::seconds(25);  // s; arming time of ArduPilot
  trial.run(20.0);
  EXPECT_EQ(trial.vehicles[0].state, FlightState::kFollow);
  EXPECT_EQ(trial.vehicles[1].state, FlightState::kIdle);
  EXPECT_EQ(trial.program.have_flown(), std::set<std::string>{"Q1"});
  trial.run(20.0);
  EXPECT_EQ(trial.vehicles[1].state, FlightState::kFollow);
  EXPECT_EQ(trial.count(OperatorAction::kLand, "Q1"), 0);
  trial.program.land_all();
  EXPECT_FALSE(trial.program.is_down());
  trial.run(10.0);
  EXPECT_TRUE(trial.program.is_down());
  const std::size_t orders_before = trial.orders.size();
  trial.run(5.0);
  EXPECT_EQ(trial.orders.size(), orders_before) << "orders are sent to landed vehicles";
}

TEST(FlightProgram, RepeatsFollowAfterVehicleHolds) {
  Trial trial({"Q1"});
  trial.run(20.0);
  ASSERT_EQ(trial.vehicles[0].state, FlightState::kFollow);
  trial.vehicles[0].state = FlightState::kHold;
  trial.run(2.0);
  EXPECT_EQ(trial.vehicles[0].state, FlightState::kHold);
  trial.run(3.0);
  EXPECT_EQ(trial.vehicles[0].state, FlightState::kFollow);
}

TEST(FlightProgram, YieldsToAnotherStationButLandsAtTheEnd) {
  Trial trial({"Q1", "Q2"});
  trial.run(20.0);
  models::OperatorCommand hold;
  hold.stamp.time = trial.now - std::chrono::hours(24);
  hold.action = OperatorAction::kHold;
  trial.program.on_other_station(hold, trial.now);  // from a replayed log
  hold.stamp.time = trial.now;
  hold.action = OperatorAction::kHeartbeat;
  trial.program.on_other_station(hold, trial.now);  // a heartbeat alone changes nothing
  hold.action = OperatorAction::kHold;
  hold.robot = "Q2";
  trial.program.on_other_station(hold, trial.now);
  trial.vehicles[0].state = FlightState::kHold;
  trial.vehicles[1].state = FlightState::kHold;
  trial.run(30.0);
  EXPECT_EQ(trial.vehicles[0].state, FlightState::kFollow);
  EXPECT_EQ(trial.vehicles[1].state, FlightState::kHold);
  trial.program.land_all();
  trial.run(10.0);
  EXPECT_TRUE(trial.program.is_down());
}

TEST(FlightProgram, DoesNotRestartALandedOrKilledVehicle) {
  for (const FlightState state : {FlightState::kIdle, FlightState::kKilled}) {
    Trial trial({"Q1"});
    trial.run(20.0);
    trial.vehicles[0].state = state;
    trial.orders.clear();
    trial.run(30.0);
    EXPECT_TRUE(trial.orders.empty());
    trial.program.land_all();
    trial.run(2.0);
    EXPECT_TRUE(trial.program.is_down());
  }
}

TEST(FlightProgram, RestartsWhenMotorsStopBeforeTakeOff) {
  Trial trial({"Q1"});
  trial.vehicles[0].arming = std::chrono::hours(1);
  trial.run(120.0);
  EXPECT_GT(trial.count(OperatorAction::kHold, "Q1"), 2);
  EXPECT_GT(trial.count(OperatorAction::kArm, "Q1"), 50);
}

}  // namespace
}  // namespace vantage::tools
