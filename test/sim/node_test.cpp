#include "sim/app/node.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/bus_pair.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

/// The node, its clock, and a subscriber that stores all messages.
struct Lab {
  bus::VirtualClock clock{kStart};
  test::BusPair net{11, 22};
  bus::Bus& sim_bus = net.own;
  bus::Bus& bus = net.other;
  SimNode node;
  std::vector<models::MocapFrame> frames;
  std::vector<Time> frames_published;
  std::vector<models::TruthFrame> truths;
  std::vector<models::VehicleStatus> statuses;
  std::vector<models::CollisionReport> contacts;

  explicit Lab(const scenario::Scenario& scenario = test::lab_scenario())
      : node(sim_bus, clock, scenario) {
    bus.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
      frames.push_back(frame);
      frames_published.push_back(clock.now());
    });
    bus.subscribe<models::TruthFrame>(
        bus::kTruth, [this](const models::TruthFrame& truth) { truths.push_back(truth); });
    bus.subscribe<models::VehicleStatus>(
        bus::vehicle_channel("*"),
        [this](const models::VehicleStatus& status) { statuses.push_back(status); });
    bus.subscribe<models::CollisionReport>(
        bus::kCollision, [this](const models::CollisionReport& c) { contacts.push_back(c); });
  }

  void run_until(Time end) {
    while (node.next_tick() <= end) {
      clock.set(node.next_tick());
      sim_bus.handle(std::chrono::microseconds(0));
      node.tick(clock.now());
      bus.handle(std::chrono::microseconds(0));
    }
    clock.set(end);
  }

  std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& counter : node.counters()) {
      if (counter.name == name) {
        return counter.count;
      }
    }
    return 0;
  }
};

models::RobotPlan forward_plan(const std::string& robot, Time start, const Pose2& from,
                               double height_m) {
  models::RobotPlan plan;
  plan.robot = robot;
  plan.round = 3;
  plan.stamp.time = start;
  plan.trajectory = {start, from, height_m, {{{1.0, 0.0}, 1.0, 0.0}, {{1.0, 0.0}, 0.5, 2.0}}};
  plan.horizon_steps = 2;
  plan.slot_start = start;
  plan.deadline = start;
  plan.finish = start;
  return plan;
}

TEST(SimNode, PublishesEachChannelAtItsRate) {
  Lab lab;
  lab.run_until(kStart + std::chrono::seconds(2));
  EXPECT_NEAR(static_cast<double>(lab.frames.size()), 100.0, 1.0);
  EXPECT_NEAR(static_cast<double>(lab.truths.size()), 40.0, 1.0);
  EXPECT_NEAR(static_cast<double>(lab.statuses.size()), 3 * 20.0, 3.0);
  EXPECT_TRUE(lab.contacts.empty());
  EXPECT_TRUE(lab.node.counters().empty());
  EXPECT_EQ(lab.node.deadlines_missed(), 0);
  for (std::size_t k = 0; k < lab.frames.size(); ++k) {
    EXPECT_EQ(to_utime(lab.frames[k].stamp.time) % 20'000, 0);
    EXPECT_EQ(lab.frames[k].arrival, lab.frames_published[k]);
    EXPECT_EQ(lab.frames[k].bodies.size(), 8u);
  }
}

TEST(SimNode, FliesAPlanFromItsStartAndBrakesAtItsEnd) {
  Lab lab;
  lab.run_until(kStart + Duration{500'000});
  const Time begin = kStart + std::chrono::seconds(1);
  lab.bus.publish(bus::plan_channel("Q2"), forward_plan("Q2", begin, {2.0, 1.0, kPi / 2}, 1.5));
  lab.run_until(begin + Duration{500'000});
  const auto& q2 = lab.node.world().quadrotors()[1];
  EXPECT_NEAR(q2.position_world_m().y(), 1.5, 0.1);
  lab.run_until(begin + std::chrono::seconds(4));
  // The path is 1 m (1 s at 1 m/s) plus ½ · 1² / 2 m for the stop.
  EXPECT_NEAR(q2.position_world_m().y(), 2.25, 0.08);
  EXPECT_NEAR(q2.position_world_m().x(), 2.0, 0.08);
  const bool is_reported = std::any_of(
      lab.statuses.begin(), lab.statuses.end(),
      [](const auto& status) { return status.robot == "Q2" && status.plan_round == 3; });
  EXPECT_TRUE(is_reported);
  EXPECT_TRUE(lab.node.counters().empty());
}

TEST(SimNode, CountsEveryRefusedPlan) {
  Lab lab;
  const Time begin = kStart + std::chrono::seconds(1);
  lab.bus.publish(bus::plan_channel("Q1"), forward_plan("Q1", begin, {1.5, 1.0, 0.0}, 1.0));
  lab.bus.publish(bus::plan_channel("Q1"), forward_plan("Q2", begin, {2.0, 1.0, 0.0}, 1.5));
  lab.bus.publish(bus::plan_channel("Q9"), forward_plan("Q9", begin, {2.0, 1.0, 0.0}, 1.5));
  models::OperatorCommand hold;
  hold.stamp.time = kStart;
  hold.action = models::OperatorAction::kHold;
  hold.robot = "Q3";
  lab.bus.publish(bus::kCommand, hold);
  lab.bus.publish(bus::plan_channel("Q3"), forward_plan("Q3", begin, {3.0, 1.0, 0.0}, 2.0));
  lab.run_until(kStart + Duration{100'000});
  EXPECT_EQ(lab.count("sim.plans_discontinuous"), 1);
  EXPECT_EQ(lab.count("sim.plans_misaddressed"), 2);
  EXPECT_EQ(lab.count("sim.plans_not_following"), 1);
}

TEST(SimNode, FollowsOperatorCommands) {
  Lab lab;
  const auto command = [&](models::OperatorAction action, const std::string& robot) {
    models::OperatorCommand message;
    message.stamp.time = lab.clock.now();
    message.action = action;
    message.robot = robot;
    lab.bus.publish(bus::kCommand, message);
  };
  command(models::OperatorAction::kHold, "Q1");
  command(models::OperatorAction::kEmergencyStop, "Q3");
  lab.run_until(kStart + Duration{50'000});
  const Time begin = kStart + std::chrono::seconds(1);
  lab.bus.publish(bus::plan_channel("Q1"), forward_plan("Q1", begin, {1.0, 1.0, 0.0}, 1.0));
  lab.run_until(kStart + std::chrono::seconds(2));
  const auto& vehicles = lab.node.world().quadrotors();
  EXPECT_EQ(vehicles[0].state(), models::FlightState::kHold);
  EXPECT_EQ(vehicles[1].state(), models::FlightState::kFollow);
  EXPECT_EQ(vehicles[2].state(), models::FlightState::kKilled);
  EXPECT_EQ(vehicles[2].position_world_m().z(), 0.0);
  EXPECT_EQ(lab.count("sim.plans_not_following"), 1);
  command(models::OperatorAction::kLand, "");
  lab.run_until(kStart + std::chrono::seconds(8));
  EXPECT_EQ(vehicles[0].state(), models::FlightState::kIdle);
  EXPECT_EQ(vehicles[1].state(), models::FlightState::kIdle);
  EXPECT_EQ(vehicles[2].state(), models::FlightState::kKilled);
}

TEST(SimNode, ReportsACollisionOnTheBus) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[0].start = {1.0, 1.0, 0.0};
  scenario.robots[1].start = {1.3, 1.0, 0.0};
  scenario.robots[1].height_m = 1.0;
  Lab lab(scenario);
  lab.run_until(kStart + Duration{100'000});
  ASSERT_EQ(lab.contacts.size(), 2u);
  EXPECT_EQ(lab.contacts[0].kind, models::CollisionKind::kCollision);
  EXPECT_EQ(lab.contacts[1].kind, models::CollisionKind::kNearMiss);
}

TEST(SimNode, CatchesUpInStepsAfterAStall) {
  Lab lab;
  lab.run_until(kStart + std::chrono::seconds(1));
  const std::size_t before = lab.frames.size();
  lab.clock.set(kStart + std::chrono::seconds(3));
  lab.node.tick(lab.clock.now());
  lab.bus.handle(std::chrono::microseconds(0));
  EXPECT_LE(lab.frames.size() - before, 20u);
  EXPECT_GT(lab.node.next_tick(), lab.clock.now());
  lab.run_until(kStart + std::chrono::seconds(4));
  EXPECT_NEAR(static_cast<double>(lab.frames.size()), 200.0, 1.0) << "no frame is missing";
  EXPECT_GT(lab.count("sim.catch_up_chunks"), 0);
  EXPECT_GT(lab.node.deadlines_missed(), 0);
}

TEST(SimNode, RefusesUnsupportedDevices) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[2].device = scenario::DeviceSource::kWire;
  EXPECT_THROW(Lab{scenario}, StartupError);
  scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kWire;
  EXPECT_THROW(Lab{scenario}, StartupError);
}

TEST(SimNode, DoesNotPublishMocapIfTheDeviceIsReal) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  Lab lab(scenario);
  lab.run_until(kStart + std::chrono::seconds(1));
  EXPECT_TRUE(lab.frames.empty());
  EXPECT_FALSE(lab.truths.empty());
}

// Returns all bytes of a run, in order of publication.
std::vector<std::uint8_t> bytes_of_run(std::uint64_t seed, Duration tick_every) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.seed = seed;
  bus::InProcessHub hub;
  bus::VirtualClock clock(kStart);
  const auto sim_side = hub.connect();
  const auto receiver = hub.connect();
  std::vector<std::uint8_t> bytes;
  receiver->subscribe("*", [&](std::string_view channel, std::span<const std::uint8_t> payload) {
    bytes.insert(bytes.end(), channel.begin(), channel.end());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
  });
  bus::Bus bus(*sim_side, 11);
  SimNode node(bus, clock, scenario);
  for (Time now = kStart; now <= kStart + std::chrono::seconds(3); now += tick_every) {
    clock.set(now);
    if (now >= node.next_tick()) {
      node.tick(now);
    }
    receiver->handle(std::chrono::microseconds(0));
  }
  return bytes;
}

TEST(SimNode, IsDeterministicForASeed) {
  const auto first = bytes_of_run(5, Duration{5'000});
  EXPECT_GT(first.size(), 100'000u);
  EXPECT_EQ(first, bytes_of_run(5, Duration{5'000}));
  EXPECT_EQ(first, bytes_of_run(5, Duration{1'000})) << "depends on the number of calls";
  EXPECT_NE(first, bytes_of_run(6, Duration{5'000}));
}

}  // namespace
}  // namespace vantage::sim
