#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "estimator/app/map_step.hpp"
#include "estimator/app/node.hpp"
#include "estimator/app/replay_node.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/estimator/occupancy/mapping_scenario.hpp"
#include "test/support/sent_ref.hpp"

// Tests the capacities of the message buffers of the estimator nodes.

namespace vantage::estimator {
namespace {

using namespace std::chrono_literals;
using models::InputRef;
using vantage::test::sent_ref;

const Time kStart = from_utime(1'700'000'000'100'000);  // 0.1 s after a multiple of τ
const Time kInstant = kStart + 400ms;

scenario::Scenario team_of(int robots) {
  scenario::Scenario scenario;
  scenario.world.bounds = {{-6.0, -6.0}, {6.0, 6.0}};
  for (int i = 0; i < robots; ++i) {
    scenario::RobotSpec robot;
    robot.name = "Q" + std::to_string(i + 1);
    scenario.robots.push_back(robot);
  }
  scenario.targets.push_back({"T0", 0, std::nullopt, 0.2});
  scenario.estimator.target_model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
  scenario.planner.step_s = 0.5;
  scenario.network.communication_range_m = 20.0;
  return scenario;
}

models::MocapFrame frame_of(Time time, const std::string& robot, const Pose2& pose) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.arrival = time;
  frame.bodies.push_back({robot, lift(pose, 1.0), false});
  return frame;
}

models::RobotMeasurement look_of(const std::string& robot, Time time) {
  models::RobotMeasurement look;
  look.stamp.time = time;
  look.robot = robot;
  return look;
}

models::RobotBelief belief_of(const std::string& robot, Time time) {
  models::RobotBelief belief = test::prior(time, {});
  belief.robot = robot;
  return belief;
}

/// Bus of the node under test, and a second bus that publishes its inputs.
struct TestBus {
  template <class Message>
  InputRef publish(const bus::Channel<Message>& channel, const Message& message) {
    const InputRef name = sent_ref(world, channel, message);
    bus.handle(0us);
    return name;
  }

  bus::VirtualClock clock{kStart};
  bus::InProcessHub hub;
  std::unique_ptr<bus::Transport> world_end = hub.connect();
  std::unique_ptr<bus::Transport> end = hub.connect();
  bus::Bus world{*world_end, 100};
  bus::Bus bus{*end, 1, "REPLAY_"};
};

// Any number of frames without the robot does not displace its poses from the buffer.
TEST(EstimatorNode, BuffersPosesOnlyFromFramesShowingTheRobot) {
  TestBus test_bus;
  const scenario::Scenario scenario = team_of(2);
  EstimatorNode node(test_bus.bus, test_bus.clock, scenario, "Q1");
  test_bus.publish(bus::kVicon, frame_of(kInstant - 10ms, "Q1", {1.0, 2.0, 0.5}));
  for (int i = 0; i < 300; ++i) {
    models::MocapFrame frame = frame_of(kInstant - 9ms, i % 2 == 0 ? "Q2" : "Q1", {4.0, 4.0, 0.0});
    frame.bodies[0].occluded = i % 2 == 1;
    test_bus.publish(bus::kVicon, frame);
  }
  test_bus.clock.set(kInstant + 60ms);
  node.tick(test_bus.clock.now());
  const models::RobotBelief made = node.filter().belief();
  EXPECT_EQ(made.stamp.time, kInstant);
  EXPECT_NEAR(made.viewpoint.world_from_body.x_m, 1.0, 1e-9);
  EXPECT_TRUE(node.counters().empty()) << "its own position is known";
}

// Inputs of a logged step are found if at most 1024 observations or 64 beliefs of each robot, or
// 2048 frames, have arrived.
TEST(EstimatorReplayNode, FindsInputsWithinBufferCapacity) {
  for (const int robots : {1, 2, 3}) {
    const scenario::Scenario scenario = team_of(robots);
    for (const std::string kind : {"look", "belief", "frame"}) {
      if (kind == "belief" && robots == 1) {
        continue;  // there is no teammate
      }
      const int room = kind == "look" ? 1024 : kind == "belief" ? 64 : 2048;
      for (const bool is_there : {true, false}) {
        TestBus test_bus;
        EstimatorReplayNode node(test_bus.bus, test_bus.clock, scenario, "Q1");
        std::vector<InputRef> names;
        for (int i = 0; i < room + 1; ++i) {
          const std::string robot = robots == 1 || kind == "frame" ? "Q1" : "Q2";
          names.push_back(
              kind == "look" ? test_bus.publish(bus::measurement_channel(robot),
                                                look_of(robot, kInstant - Duration{i}))
              : kind == "belief"
                  ? test_bus.publish(bus::belief_channel(robot),
                                     belief_of(robot, kInstant - Duration{i}))
                  : test_bus.publish(bus::kVicon, frame_of(kInstant - Duration{i}, robot, {})));
        }
        models::RobotBelief logged = belief_of("Q1", kInstant);
        logged.inputs = {names[is_there ? 1 : 0], names.back()};
        test_bus.publish(bus::belief_channel("Q1"), logged);
        for (int i = 0; i < 30; ++i) {
          test_bus.clock.set(test_bus.clock.now() + 100ms);
          node.tick(test_bus.clock.now());
        }
        EXPECT_EQ(node.inputs_missing(), is_there ? 0 : 1) << robots << kind;
        EXPECT_EQ(node.steps_redone(), is_there ? 1 : 0) << robots << kind;
        EXPECT_EQ(node.steps_rebased(), is_there ? 0 : 1) << robots << kind;
      }
    }
  }
}

// The replay buffers keep 64 beliefs, 256 scans, and 16 maps of each robot.
TEST(MapReplayer, FindsInputsWithinBufferCapacity) {
  for (const int robots : {1, 2, 3}) {
    std::vector<std::string> names;
    for (int i = 0; i < robots; ++i) {
      names.push_back("Q" + std::to_string(i + 1));
    }
    const scenario::Scenario scenario = vantage::test::mapping_scenario(names);
    models::RobotMap map;
    map.stamp.time = kInstant;
    map.grid = models::map_geometry(scenario.world, scenario.mapping);
    map.own_looks.assign(static_cast<std::size_t>(map.grid.size()), 0);
    map.team_looks = map.own_looks;
    models::RangeScan scan;
    scan.stamp.time = kInstant;
    scan.robot = "Q1";
    scan.field_of_view_rad = scenario.mapping.scanner.field_of_view_rad;
    scan.range_max_m = scenario.mapping.scanner.range_max_m;
    scan.ranges_m.assign(static_cast<std::size_t>(scenario.mapping.scanner.beams), 1.5);
    for (const std::string kind : {"belief", "scan", "map"}) {
      if (kind == "map" && robots == 1) {
        continue;  // there is no teammate
      }
      for (const bool is_there : {true, false}) {
        TestBus test_bus;
        MapReplayer replayer(test_bus.bus, scenario, "Q1");
        std::vector<InputRef> published;
        const int room = kind == "belief" ? 65 : kind == "scan" ? 257 : 17;
        map.robot = "Q2";
        for (int i = 0; i < room; ++i) {
          published.push_back(kind == "belief" ? test_bus.publish(bus::belief_channel("Q1"),
                                                                  belief_of("Q1", kInstant))
                              : kind == "scan" ? test_bus.publish(bus::scan_channel("Q1"), scan)
                                               : test_bus.publish(bus::map_channel("Q2"), map));
        }
        map.inputs = {published[is_there ? 1 : 0]};
        if (kind != "belief") {
          map.inputs.push_back(
              test_bus.publish(bus::belief_channel("Q1"), belief_of("Q1", kInstant)));
        }
        map.robot = "Q1";
        test_bus.publish(bus::map_channel("Q1"), map);
        map.inputs.clear();
        for (int i = 0; i < 30; ++i) {
          replayer.tick();
        }
        EXPECT_EQ(replayer.counters().empty(), is_there) << robots << kind;
      }
    }
  }
}

// The last belief of a silent teammate is used while it is fresh, counted as stale once, and then
// dropped.
TEST(NodeBuffers, KeepATeammatesBeliefWhileFresh) {
  const scenario::Scenario scenario = team_of(2);
  for (const auto& [late, uses] : {std::pair(0us, 3), std::pair(1us, 3), std::pair(-1us, 2)}) {
    TestBus test_bus;
    EstimatorNode node(test_bus.bus, test_bus.clock, scenario, "Q1");
    test_bus.publish(bus::kVicon, frame_of(kInstant, "Q1", {}));
    test_bus.publish(bus::belief_channel("Q2"), belief_of("Q2", kInstant - 500ms + late));
    int used = 0;
    for (int step = 0; step < 6; ++step) {
      test_bus.clock.set(kInstant + step * 500ms + 60ms);
      node.tick(test_bus.clock.now());
      used += node.filter().belief().degree == 1 ? 1 : 0;
    }
    EXPECT_EQ(used, uses) << "1.5 s";
    EXPECT_EQ(node.filter().counters().stale_beliefs, 1);
  }
}

}  // namespace
}  // namespace vantage::estimator
