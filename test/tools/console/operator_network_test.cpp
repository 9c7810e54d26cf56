#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"
#include "bus/transport/transport.hpp"
#include "logs/record/log_space.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/bus/auth/auth_support.hpp"
#include "test/support/bus_pair.hpp"
#include "tools/check/arming_watch.hpp"
#include "tools/check/preflight.hpp"
#include "tools/console/console.hpp"
#include "tools/console/order_queue.hpp"

namespace vantage::tools {
namespace {

using models::OperatorAction;
constexpr Time kStart = from_utime(1'700'000'000'000'000);

scenario::Scenario lab() { return scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml"); }

bool mentions(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(words) != std::string::npos;
  });
}

TEST(OrderSender, AllowsTheSecondStationOnlyAnEmergencyStop) {
  bus::InProcessHub hub;
  const auto link_a = hub.connect();
  const auto link_b = hub.connect();
  const auto link_v = hub.connect();
  bus::Bus bus_a(*link_a, 11);
  bus::Bus bus_b(*link_b, 12);
  bus::Bus vehicle(*link_v, 13);
  std::vector<models::OperatorCommand> orders;
  vehicle.subscribe<models::OperatorCommand>(
      bus::kCommand, [&](const models::OperatorCommand& command) { orders.push_back(command); });
  OrderSender first(bus_a, {}, kStart);
  std::optional<OrderSender> second;
  for (int i = 0; i < 40; ++i) {
    const Time now = kStart + from_seconds(0.1 * i);
    if (i == 20) {
      second.emplace(bus_b, StationOptions{}, now);
    }
    for (bus::Bus* each : {&bus_a, &bus_b, &vehicle}) {
      each->handle(std::chrono::microseconds(0));
    }
    (void)first.tick(now);
    if (second) {
      (void)second->tick(now);
    }
  }
  const Time now = kStart + from_seconds(4.0);
  EXPECT_TRUE(first.send(now, OperatorAction::kArm, ""));
  EXPECT_FALSE(second->send(now, OperatorAction::kArm, ""));
  EXPECT_FALSE(second->send(now, OperatorAction::kHold, ""));
  EXPECT_TRUE(second->send(now, OperatorAction::kEmergencyStop, ""));
  EXPECT_TRUE(first.send(now, OperatorAction::kEmergencyStop, ""));
  vehicle.handle(std::chrono::microseconds(0));
  const auto count = [&](std::int64_t run, OperatorAction action) {
    return std::count_if(orders.begin(), orders.end(), [&](const models::OperatorCommand& command) {
      return command.stamp.run_id == run && command.action == action;
    });
  };
  EXPECT_GT(count(11, OperatorAction::kHeartbeat), 10);
  EXPECT_EQ(count(12, OperatorAction::kHeartbeat), 0);
  EXPECT_EQ(count(12, OperatorAction::kArm), 0);
  EXPECT_EQ(count(12, OperatorAction::kEmergencyStop), 1) << "both stops arrive";
  EXPECT_EQ(count(11, OperatorAction::kEmergencyStop), 1);
}

// The orders of a console with a wrong clock are accepted, since they contain the vehicles' time.
TEST(OrderSender, StampsOrdersByVehicleClock) {
  for (const Duration off : {Duration(-std::chrono::hours(24)), Duration(std::chrono::hours(1)),
                             Duration(std::chrono::milliseconds(300))}) {
    test::BusPair net(11, 13);
    bus::Bus& station_bus = net.own;
    bus::Bus& vehicle = net.other;
    std::vector<models::OperatorCommand> orders;
    vehicle.subscribe<models::OperatorCommand>(
        bus::kCommand, [&](const models::OperatorCommand& command) { orders.push_back(command); });
    OrderSender sender(station_bus, {}, kStart + off);
    Time now = kStart;
    for (int i = 0; i < 30; ++i) {
      now = kStart + from_seconds(0.1 * i);
      models::VehicleStatus status;
      status.robot = "Q1";
      status.stamp.time = now;
      vehicle.publish(bus::vehicle_channel("Q1"), status);
      station_bus.handle(std::chrono::microseconds(0));
      (void)sender.tick(now + off);
    }
    orders.clear();
    EXPECT_TRUE(sender.send(now + off, OperatorAction::kEmergencyStop, ""));
    vehicle.handle(std::chrono::microseconds(0));
    ASSERT_FALSE(orders.empty());
    EXPECT_TRUE(std::any_of(orders.begin(), orders.end(), [&](const auto& command) {
      return command.action == OperatorAction::kEmergencyStop &&
             std::chrono::abs(command.stamp.time - now) <= std::chrono::milliseconds(300);
    }));
  }
}

// When the operator page is closed, the heartbeat ends, as at the end of a console.
TEST(OrderSender, SendsNoHeartbeatWithoutAnOperator) {
  test::BusPair net(11, 13);
  int beats = 0;
  net.other.subscribe<models::OperatorCommand>(
      bus::kCommand, [&](const models::OperatorCommand& command) {
        beats += command.action == OperatorAction::kHeartbeat ? 1 : 0;
      });
  OrderSender sender(net.own, {}, kStart);
  Time now = kStart;
  const auto beats_in = [&](double duration_s) {
    beats = 0;
    for (double s = 0.0; s < duration_s; s += 0.05) {
      now += from_seconds(0.05);
      (void)sender.tick(now);
      net.other.handle(std::chrono::microseconds(0));
    }
    return beats;
  };
  EXPECT_TRUE(sender.set_attended(false, now));
  EXPECT_FALSE(sender.set_attended(false, now)) << "no change";
  EXPECT_EQ(beats_in(3.0), 0);
  EXPECT_TRUE(sender.send(now, OperatorAction::kEmergencyStop, "")) << "always possible";
  EXPECT_FALSE(sender.send(now, OperatorAction::kFollow, ""));
  EXPECT_TRUE(sender.set_attended(true, now));
  EXPECT_EQ(beats_in(Station::kListenS - 0.1), 0) << "listens for other stations first";
  EXPECT_GE(beats_in(2.0), 8);
  EXPECT_TRUE(sender.set_attended(false, now));
  EXPECT_EQ(beats_in(2.0), 0);
}

TEST(OrderSender, ShowsALogError) {
  test::BusPair net(11, 12);
  bus::Bus& station_bus = net.own;
  bus::Bus& up_bus = net.other;
  OrderSender sender(station_bus, {}, kStart);
  logs::LogWatch log(300e3);
  const auto report_log_size = [&](Time now, std::uint64_t size_bytes) {
    (void)log.update({size_bytes, 0}, now);
    up_bus.publish(bus::health_channel(logs::kLogHealth), log.health(now));
    (void)sender.tick(now);
    station_bus.handle(std::chrono::microseconds(0));
    return mentions(sender.vehicle_table(now, ""), "the log is not being written");
  };
  EXPECT_FALSE(report_log_size(kStart, 1000));
  EXPECT_TRUE(report_log_size(kStart + std::chrono::seconds(3), 1000));
  EXPECT_FALSE(sender.is_log_lost(kStart + std::chrono::seconds(7))) << "no longer reported";
  EXPECT_FALSE(report_log_size(kStart + std::chrono::seconds(8), 2000));
}

// In a one-way partition, each side detects the fault independently: the vehicles by missing
// heartbeats (fault 17), the operator by the silence of the vehicles.
TEST(OrderSender, ShowsSilentVehicleInOneWayPartition) {
  test::BusPair net(11, 13);
  bus::Bus& station_bus = net.own;
  bus::Bus& vehicle = net.other;
  OrderSender sender(station_bus, {}, kStart);
  models::VehicleStatus status;
  status.robot = "Q1";
  status.state = models::FlightState::kFollow;
  status.stamp.time = kStart;
  vehicle.publish(bus::vehicle_channel("Q1"), status);
  station_bus.handle(std::chrono::microseconds(0));
  EXPECT_TRUE(mentions(sender.vehicle_table(kStart + from_seconds(0.9), ""), "follow"));
  const auto later = sender.vehicle_table(kStart + from_seconds(1.1), "");
  EXPECT_TRUE(mentions(later, "SILENT"));
  EXPECT_FALSE(mentions(later, "follow"));
}

/// A station in charge whose datagrams are lost while `is_lossy` returns true.
struct LossyDesk {
  test::BusPair net{11, 13};
  bus::Bus& vehicle = net.other;
  OrderSender sender{net.own, {}, kStart};
  std::function<bool(Time)> is_lossy = [](Time) { return false; };
  std::vector<models::OperatorCommand> orders;
  Time now = kStart;

  LossyDesk() {
    vehicle.subscribe<models::OperatorCommand>(bus::kCommand,
                                               [this](const models::OperatorCommand& command) {
                                                 if (!is_lossy(now)) {
                                                   orders.push_back(command);
                                                 }
                                               });
    pass(1.0);
  }
  void pass(double seconds) {
    const Time end = now + from_seconds(seconds);
    while (now < end) {
      now += std::chrono::milliseconds(10);
      (void)sender.tick(now);
      vehicle.handle(std::chrono::microseconds(0));
    }
  }
  void send(OperatorAction action, const std::string& robot = "") {
    EXPECT_TRUE(sender.send(now, action, robot));
    vehicle.handle(std::chrono::microseconds(0));
  }
  std::int64_t count(OperatorAction action, const std::string& robot = "") const {
    return std::count_if(orders.begin(), orders.end(), [&](const models::OperatorCommand& command) {
      return command.action == action && command.robot == robot;
    });
  }
};

TEST(OrderSender, OrderArrivesDespiteHalfASecondOfLoss) {
  for (const OperatorAction action :
       {OperatorAction::kHold, OperatorAction::kLand, OperatorAction::kEmergencyStop}) {
    LossyDesk lab;
    const Time given = lab.now;
    lab.is_lossy = [given](Time now) { return now - given < std::chrono::milliseconds(500); };
    lab.send(action);
    lab.pass(0.49);
    EXPECT_EQ(lab.count(action), 0);
    lab.pass(0.5);
    ASSERT_GE(lab.count(action), 1);
    EXPECT_EQ(lab.orders.back().action, OperatorAction::kHeartbeat) << "the heartbeat continues";
    EXPECT_FALSE(lab.sender.is_repeating());
  }
}

TEST(OrderSender, RepeatsOrderForALimitedTime) {
  LossyDesk lab;
  const Time given = lab.now;
  lab.send(OperatorAction::kEmergencyStop, "Q1");
  lab.pass(0.06);
  EXPECT_EQ(lab.count(OperatorAction::kEmergencyStop, "Q1"), 2)
      << "the second transmission follows soon";
  lab.pass(10.0);
  EXPECT_EQ(lab.count(OperatorAction::kEmergencyStop, "Q1"), OrderSender::kTransmissions);
  for (const models::OperatorCommand& command : lab.orders) {
    if (command.action == OperatorAction::kEmergencyStop) {
      EXPECT_EQ(command.stamp.time, given);
    }
  }
  lab.orders.clear();
  lab.send(OperatorAction::kArm);
  lab.pass(2.0);
  EXPECT_EQ(lab.count(OperatorAction::kArm), 1) << "orders that are not safer are sent once";
}

TEST(OrderSender, DoesNotRepeatRevokedOrder) {
  LossyDesk lab;
  lab.send(OperatorAction::kHold);
  lab.send(OperatorAction::kFollow, "Q1");
  lab.pass(2.0);
  EXPECT_EQ(lab.count(OperatorAction::kHold), 1);
  lab.send(OperatorAction::kHold, "Q2");
  lab.send(OperatorAction::kFollow, "Q1");
  lab.pass(2.0);
  EXPECT_EQ(lab.count(OperatorAction::kHold, "Q2"), OrderSender::kTransmissions)
      << "orders for Q1 are separate";
  lab.send(OperatorAction::kEmergencyStop);
  lab.send(OperatorAction::kArm, "Q1");
  lab.pass(2.0);
  EXPECT_EQ(lab.count(OperatorAction::kEmergencyStop), OrderSender::kTransmissions);
  lab.orders.clear();
  lab.send(OperatorAction::kEmergencyStop);
  lab.send(OperatorAction::kArm);
  lab.pass(2.0);
  EXPECT_EQ(lab.count(OperatorAction::kEmergencyStop), 1);
}

/// A monitor of the lab's processes, and the bus of one of these processes.
struct WatchedLab {
  test::BusPair net{1, 2};
  scenario::Scenario scenario = lab();
  ArmingWatch watch{net.other, scenario};
};

TEST(ArmingWatch, ReportsMissingVehiclesAndDriverReasons) {
  WatchedLab lab;
  const ArmingWatch& watch = lab.watch;
  EXPECT_TRUE(mentions(watch.blocks(), "no mocap frame"));
  EXPECT_TRUE(mentions(watch.blocks(), "no operator heartbeat"));

  models::MocapFrame frame;
  frame.stamp.time = frame.arrival = kStart;
  for (const scenario::RobotSpec& robot : lab.scenario.robots) {
    models::MocapBody body;
    body.name = robot.name;
    body.occluded = robot.name == "Q2";
    frame.bodies.push_back(body);
    models::VehicleStatus status;
    status.stamp.time = kStart;
    status.robot = robot.name;
    if (robot.name == "Q3") {
      status.reasons = {"battery for take-off"};
    }
    lab.net.own.publish(bus::vehicle_channel(robot.name), status);
  }
  lab.net.own.publish(bus::kVicon, frame);
  models::OperatorCommand beat;
  beat.stamp.time = kStart;
  lab.net.own.publish(bus::kCommand, beat);
  lab.net.other.handle(std::chrono::microseconds(0));
  const std::vector<std::string> blocks = watch.blocks();
  EXPECT_EQ(blocks.size(), 2U);
  EXPECT_TRUE(mentions(blocks, "Q2: mocap frames contain no body"));
  EXPECT_TRUE(mentions(blocks, "Q3: battery for take-off"));
}

TEST(ArmingWatch, NamesMessagesOfAnotherVersion) {
  WatchedLab lab;
  const ArmingWatch& watch = lab.watch;
  EXPECT_FALSE(mentions(watch.blocks(), "version"));
  const std::vector<std::uint8_t> other_type(64, 7);
  lab.net.own_link->publish("PLAN_Q1", other_type);
  lab.net.own_link->publish("PLAN_Q1", other_type);
  lab.net.other.handle(std::chrono::microseconds(0));
  EXPECT_TRUE(mentions(watch.blocks(), "2 messages on PLAN_Q1 cannot be decoded"));
}

TEST(ArmingWatch, ReportsMessagesRefusedDuringArming) {
  WatchedLab lab;
  const ArmingWatch& watch = lab.watch;
  models::ProcessHealth health;
  health.process = "QUADROTOR_Q1";
  const auto report = [&](std::vector<models::NamedCount> counters) {
    health.counters = std::move(counters);
    lab.net.own.publish(bus::health_channel(health.process), health);
    lab.net.other.handle(std::chrono::microseconds(0));
  };
  report({{"COMMAND.unsigned", 3}});
  report({{"COMMAND.unsigned", 3}});
  EXPECT_FALSE(mentions(watch.blocks(), "COMMAND: process")) << "before the watch begins";
  report({{"COMMAND.unsigned", 3}, {"VICON.bad_mac", 12}, {"VICON.lost", 5}});
  EXPECT_TRUE(mentions(watch.blocks(),
                       "VICON: process QUADROTOR_Q1 refused 12 messages "
                       "during this check (bad_mac)"));
  EXPECT_FALSE(mentions(watch.blocks(), "COMMAND: process"));
  EXPECT_FALSE(mentions(watch.blocks(), "lost"));
}

TEST(OrderSender, ReportsThatUnsignedOrdersAreRefused) {
  test::BusPair net(11, 13);
  bus::Bus& bus = net.own;
  bus::Bus& vehicle = net.other;
  const bus::VirtualClock clock(kStart);
  const OrderSender sender(bus, {}, kStart);
  const auto report_status = [&] {
    models::VehicleStatus status;
    status.robot = "Q1";
    vehicle.publish(bus::vehicle_channel("Q1"), status);
    bus.handle(std::chrono::microseconds(0));
  };
  report_status();
  EXPECT_FALSE(sender.lacks_signature());
  vehicle.secure(test::authenticator(test::keys_of_a_trial()), clock);
  report_status();
  EXPECT_TRUE(sender.lacks_signature());
  EXPECT_TRUE(mentions(sender.vehicle_table(kStart, ""), "--scenario"));
}

/// A console of a trial that requires signatures, and the network.
struct SecuredConsole {
  explicit SecuredConsole(Time now) : clock(now) {
    auto authenticator = test::authenticator(test::keys_of_a_trial());
    options.authenticator = authenticator.get();
    bus.secure(std::move(authenticator), clock);
    sender.emplace(bus, options, now);
  }
  /// Advances the clock by `time` in steps, and calls `each` in every step.
  void pass(Duration time, const std::function<void()>& each) {
    for (const Time end = clock.now() + time; clock.now() < end;) {
      clock.set(clock.now() + std::chrono::milliseconds(100));
      each();
      while (bus.handle(std::chrono::microseconds(0)) > 0) {
      }
      (void)sender->tick(clock.now());
    }
  }

  bus::InProcessHub hub;
  bus::VirtualClock clock;
  std::unique_ptr<bus::Transport> link = hub.connect();
  std::unique_ptr<bus::Transport> others = hub.connect();
  bus::Bus bus{*link, 11};
  StationOptions options;
  std::optional<OrderSender> sender;
};

// The log of a signed trial that has ended is replayed ten seconds later.
TEST(OrderSender, IgnoresRobotsOfAPlayedLog) {
  SecuredConsole console(kStart + std::chrono::seconds(10));
  bus::VirtualClock then(kStart);
  const auto recorder = console.hub.connect();
  std::vector<std::vector<std::uint8_t>> log;
  recorder->subscribe("VEHICLE_Q1", [&](std::string_view /*name*/, const bus::Payload& bytes) {
    const std::span<const std::uint8_t> all = bytes;
    log.emplace_back(all.begin(), all.end());
  });
  bus::Bus vehicle(*console.others, 13);
  vehicle.secure(test::authenticator(test::keys_of_a_trial()), then);
  for (int i = 0; i < 30; ++i) {
    then.set(then.now() + std::chrono::milliseconds(100));
    models::VehicleStatus status;
    status.robot = "Q1";
    status.stamp.time = then.now();
    vehicle.publish(bus::vehicle_channel("Q1"), status);
    recorder->handle(std::chrono::microseconds(0));
  }
  ASSERT_EQ(log.size(), 30U);
  std::size_t played = 0;
  console.pass(std::chrono::seconds(2),
               [&] { console.others->publish("VEHICLE_Q1", log[played++]); });
  EXPECT_TRUE(console.sender->robots().empty());
  const auto table = console.sender->vehicle_table(console.clock.now(), "");
  EXPECT_TRUE(mentions(table, "no vehicle status received yet"));
  EXPECT_TRUE(mentions(table, "vehicle statuses refused: -1"));
  OrderQueue orders(*console.sender);
  EXPECT_TRUE(mentions(orders.add({OperatorAction::kLand, "Q1"}, console.clock.now()),
                       "no message received from robot 'Q1'"));
  EXPECT_TRUE(orders.was_refused());
}

// A station with a wrong clock refuses the vehicles' messages, but can still make the vehicles
// safer.
TEST(OrderSender, StampsStopInTheClockOfRefusedStatuses) {
  const Duration off = std::chrono::hours(1);
  SecuredConsole console(kStart + off);
  bus::VirtualClock true_clock(kStart);
  bus::Bus vehicle(*console.others, 13);
  vehicle.secure(test::authenticator(test::keys_of_a_trial()), true_clock);
  vehicle.act_as_vehicle("Q1");
  std::vector<models::OperatorCommand> received;
  vehicle.subscribe<models::OperatorCommand>(
      bus::kCommand, [&](const models::OperatorCommand& command) { received.push_back(command); });
  console.pass(std::chrono::seconds(2), [&] {
    true_clock.set(console.clock.now() - off);
    models::VehicleStatus status;
    status.robot = "Q1";
    status.stamp.time = true_clock.now();
    vehicle.publish(bus::vehicle_channel("Q1"), status);
  });
  EXPECT_TRUE(console.sender->robots().empty());
  received.clear();
  EXPECT_TRUE(console.sender->send(console.clock.now(), OperatorAction::kLand, ""));
  while (vehicle.handle(std::chrono::microseconds(0)) > 0) {
  }
  EXPECT_TRUE(std::any_of(received.begin(), received.end(), [&](const auto& command) {
    return command.action == OperatorAction::kLand &&
           std::chrono::abs(command.stamp.time - true_clock.now()) <= std::chrono::seconds(1);
  }));
}

TEST(OrderSender, LimitsNumberOfVehicles) {
  test::BusPair net(11, 13);
  OrderSender sender(net.own, {}, kStart);
  const auto receive_status = [&](const std::string& robot, Time now) {
    (void)sender.tick(now);
    models::VehicleStatus status;
    status.robot = robot;
    status.stamp.time = now;
    net.other.publish(bus::vehicle_channel(robot), status);
    while (net.own.handle(std::chrono::microseconds(0)) > 0) {
    }
  };
  for (int i = 0; i < 1'100; ++i) {
    receive_status("X" + std::to_string(i), kStart);
  }
  EXPECT_EQ(sender.robots().size(), OrderSender::kVehiclesMax);
  receive_status("Q1", kStart + std::chrono::seconds(4));
  const auto robots = sender.robots();
  EXPECT_EQ(robots.size(), OrderSender::kVehiclesMax);
  EXPECT_TRUE(std::find(robots.begin(), robots.end(), "Q1") != robots.end())
      << "replaces a silent vehicle";
}

TEST(CheckPreflight, AppliesTheRulesOfFlightSafety) {
  scenario::Scenario scenario = lab();
  scenario.planner.separation_m = 0.5;  // m; the sum of two radii
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "touch at that distance"));
  scenario = lab();
  scenario.robots[1].primitives.push_back({1.0, 20.0});
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "robot Q2: flight safety rejects"));
  scenario = lab();
  scenario.robots[2].height_m = scenario.world.ceiling_m;
  EXPECT_TRUE(mentions(check_preflight(scenario).faults, "below the ceiling"));
}

}  // namespace
}  // namespace vantage::tools
