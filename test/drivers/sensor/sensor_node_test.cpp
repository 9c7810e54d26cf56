#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "drivers/sensor/app/node.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/sent_ref.hpp"

namespace vantage::drivers {
namespace {

// Start time; a multiple of the step τ = 0.5 s.
constexpr Time kStart = from_utime(1'700'000'000'000'000);

struct Bench {
  bus::InProcessHub hub;
  bus::VirtualClock clock{kStart};
  std::unique_ptr<bus::Transport> sensor_side = hub.connect();
  std::unique_ptr<bus::Transport> mocap_side = hub.connect();
  bus::Bus sensor_bus{*sensor_side, 11};
  bus::Bus bus{*mocap_side, 22};
  SensorNode node;
  std::vector<models::RobotMeasurement> measured;
  std::vector<models::RangeScan> scanned;
  Duration mocap_clock{};  ///< offset of the publisher's clock
  std::int64_t frames = 0;

  explicit Bench(const scenario::Scenario& scenario = test::lab_scenario())
      : node(sensor_bus, clock, scenario, "Q1") {
    bus.subscribe<models::RangeScan>(
        bus::scan_channel("Q1"),
        [this](const models::RangeScan& scan) { scanned.push_back(scan); });
    bus.subscribe<models::RobotMeasurement>(
        bus::measurement_channel("Q1"),
        [this](const models::RobotMeasurement& set) { measured.push_back(set); });
  }

  /// Publishes a frame: Q1 moves along x at 1 m/s from (1, 4), and a rover stays 0.5 m ahead of it.
  models::InputRef send_frame(Duration after_start, bool is_seen = true) {
    models::MocapFrame frame;
    frame.stamp.time = kStart + after_start + mocap_clock;
    frame.arrival = frame.stamp.time + Duration{5'000};
    frame.frame_number = ++frames;
    clock.set(kStart + after_start + Duration{6'000});
    const double x_m = 1.0 + to_seconds(after_start);
    frame.bodies.resize(2);
    frame.bodies[0].name = "Q1";
    frame.bodies[0].world_from_body = lift({x_m, 4.0, 0.0}, 1.0);
    frame.bodies[0].occluded = !is_seen;
    frame.bodies[1].name = "ROVER1";
    frame.bodies[1].world_from_body = lift({x_m + 0.5, 4.0, 0.0}, 0.0);
    const models::InputRef ref = vantage::test::sent_ref(bus, bus::kVicon, frame);
    sensor_bus.handle(std::chrono::microseconds(0));
    bus.handle(std::chrono::microseconds(0));
    return ref;
  }

  void send_attack(const std::vector<std::string>& jammed) {
    models::AttackNotice attack;
    attack.stamp.time = kStart;
    attack.jammed = jammed;
    bus.publish(bus::kAttack, attack);
    sensor_bus.handle(std::chrono::microseconds(0));
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

TEST(SensorNode, MeasuresAtMultiplesOfTheStep) {
  Bench bench;
  std::vector<models::InputRef> refs;
  for (int k = 0; k <= 100; ++k) {
    refs.push_back(bench.send_frame(k * Duration{20'000}));
  }
  ASSERT_EQ(bench.measured.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    const models::RobotMeasurement& set = bench.measured[k];
    EXPECT_EQ(set.stamp.time, kStart + static_cast<int>(k) * Duration{500'000});
    EXPECT_EQ(set.robot, "Q1");
    EXPECT_NEAR(set.viewpoint.world_from_body.x_m, 1.0 + 0.5 * static_cast<double>(k), 1e-12);
    EXPECT_EQ(set.viewpoint.height_m, 1.0);
    EXPECT_EQ(set.inputs, std::vector<models::InputRef>{refs[25 * k]});
    ASSERT_EQ(set.detections.size(), 1u);
    EXPECT_EQ(set.detections[0].target_id, 0);
  }
  EXPECT_TRUE(bench.node.counters().empty());
}

TEST(SensorNode, PublishesDetectionsWithoutIdsWhenConfigured) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[0].detection = {1.0, 2.0, false};
  Bench bench(scenario);
  for (int k = 0; k <= 500; ++k) {
    bench.send_frame(k * Duration{20'000});
  }
  ASSERT_EQ(bench.measured.size(), 21u);
  std::size_t detections = 0;
  for (const models::RobotMeasurement& set : bench.measured) {
    detections += set.detections.size();
    for (const models::Detection& each : set.detections) {
      EXPECT_EQ(each.target_id, models::kNoTargetId);
    }
  }
  EXPECT_GT(detections, 21u + 20u);  // the mean is 42 false alarms, σ 6.5
}

TEST(SensorNode, InterpolatesToTheExactStepBetweenFrames) {
  Bench bench;
  bench.send_frame(Duration{480'000});
  const models::InputRef before = bench.send_frame(Duration{497'000});
  EXPECT_TRUE(bench.measured.empty()) << "the node waits for the next frame";
  const models::InputRef after = bench.send_frame(Duration{514'000});
  ASSERT_EQ(bench.measured.size(), 1u);
  EXPECT_EQ(bench.measured[0].stamp.time, kStart + Duration{500'000});
  EXPECT_NEAR(bench.measured[0].viewpoint.world_from_body.x_m, 1.5, 1e-12);
  EXPECT_EQ(bench.measured[0].inputs, (std::vector<models::InputRef>{before, after}));
  bench.send_frame(Duration{531'000});
  EXPECT_EQ(bench.measured.size(), 1u);
}

TEST(SensorNode, SkipsAndCountsStepsWithinALongGapBetweenFrames) {
  Bench bench;
  bench.send_frame(Duration{10'000});
  bench.send_frame(Duration{1'710'000});
  EXPECT_TRUE(bench.measured.empty());
  EXPECT_EQ(bench.count("sensor.steps_without_frames"), 3);
  bench.send_frame(Duration{3'000'000});
  ASSERT_EQ(bench.measured.size(), 1u);
  EXPECT_EQ(bench.count("sensor.steps_without_frames"), 5);
}

TEST(SensorNode, CountsStepsAtWhichItsRobotIsNotSeen) {
  Bench bench;
  bench.send_frame(Duration{0}, false);
  EXPECT_TRUE(bench.measured.empty());
  EXPECT_EQ(bench.count("sensor.steps_without_own_pose"), 1);
}

TEST(SensorNode, UsesLocalTimeAfterAClockChange) {
  for (const Duration set :
       {Duration{-std::chrono::hours(1)}, Duration{-std::chrono::seconds(1)},
        Duration{-std::chrono::milliseconds(500)}, Duration{std::chrono::hours(1)}}) {
    Bench bench;
    for (int k = 0; k <= 100; ++k) {
      bench.mocap_clock = k < 40 ? Duration{} : set;
      bench.send_frame(k * Duration{20'000});
    }
    ASSERT_EQ(bench.measured.size(), 5u) << to_seconds(set);
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_EQ(bench.measured[k].stamp.time, kStart + static_cast<int>(k) * Duration{500'000});
      EXPECT_NEAR(bench.measured[k].viewpoint.world_from_body.x_m,
                  1.0 + 0.5 * static_cast<double>(k), 1e-6);
    }
  }
}

TEST(SensorNode, MeasuresNothingWhileItIsJammed) {
  Bench bench;
  bench.send_attack({"Q2"});
  bench.send_frame(Duration{0});
  bench.send_attack({"Q2", "Q1"});
  bench.send_frame(Duration{500'000});
  bench.send_attack({});
  bench.send_frame(Duration{1'000'000});
  ASSERT_EQ(bench.measured.size(), 3u);
  EXPECT_FALSE(bench.measured[0].jammed);
  EXPECT_EQ(bench.measured[0].detections.size(), 1u);
  EXPECT_TRUE(bench.measured[1].jammed);
  EXPECT_TRUE(bench.measured[1].detections.empty());
  ASSERT_EQ(bench.measured[1].inputs.size(), 2u);
  EXPECT_EQ(bench.measured[1].inputs[1].channel, "ATTACK");
  EXPECT_FALSE(bench.measured[2].jammed);
}

// Attack notices are repeated every second. Without a time limit, robots would stay jammed for the
// rest of the flight if the sender ended during an attack.
TEST(SensorNode, ForgetsAnAttackNoticeAfterThreeSeconds) {
  Bench bench;
  const auto measure_at = [&](Duration after_start) {
    bench.clock.set(kStart + after_start);
    bench.send_frame(after_start);
    return bench.measured.back().jammed;
  };
  bench.clock.set(kStart + Duration{100'000});
  bench.send_attack({"Q1"});
  EXPECT_TRUE(measure_at(Duration{500'000}));
  EXPECT_TRUE(measure_at(Duration{3'000'000}));
  bench.send_attack({"Q1"});  // same stamp as before; the time limit counts from the reception
  EXPECT_TRUE(measure_at(Duration{3'500'000}));
  EXPECT_TRUE(measure_at(Duration{6'000'000}));
  EXPECT_FALSE(measure_at(Duration{6'500'000}));
  EXPECT_EQ(bench.measured.back().detections.size(), 1u);
  EXPECT_EQ(bench.measured.back().inputs.size(), 1u) << "the old notice is not an input either";
  bench.send_attack({"Q1"});
  EXPECT_TRUE(measure_at(Duration{7'000'000}));
}

scenario::Scenario mapping_scenario() {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.objective = scenario::PlanObjective::kMapping;
  scenario.mapping.scanner = {4, 2.0 * kPi, 0.0, 2.5, 0.001};
  return scenario;
}

TEST(SensorNode, PublishesScansInMappingScenariosUnlessJammed) {
  Bench bench(mapping_scenario());
  bench.send_frame(Duration{0});
  bench.send_attack({"Q1"});
  bench.send_frame(Duration{500'000});
  ASSERT_EQ(bench.scanned.size(), 2u);
  const models::RangeScan& scan = bench.scanned[0];
  EXPECT_EQ(scan.stamp.time, kStart);
  EXPECT_EQ(scan.robot, "Q1");
  EXPECT_EQ(scan.viewpoint.world_from_body.x_m, 1.0);
  EXPECT_FALSE(scan.jammed);
  ASSERT_EQ(scan.ranges_m.size(), 4u);  // room of 4 × 8 m, seen from (1, 4) with a wall 1 m behind
  EXPECT_EQ(scan.range_max_m, 2.5);
  const models::BeamSensor scanner = mapping_scenario().mapping.scanner;
  for (int beam = 0; beam < 4; ++beam) {
    const bool is_behind = std::abs(std::abs(scanner.bearing_rad(beam)) - kPi) < 1e-9;
    const bool is_right = std::abs(scanner.bearing_rad(beam) + kPi / 2) < 1e-9;
    const double wanted_m = is_behind ? 1.0 : is_right ? 1.0 : 2.5;  // obstacle at y = 2.5 to 3
    EXPECT_NEAR(scan.ranges_m[static_cast<std::size_t>(beam)], wanted_m, 0.01) << beam;
  }
  ASSERT_EQ(scan.inputs.size(), 1u);
  EXPECT_TRUE(bench.scanned[1].jammed);
  EXPECT_TRUE(bench.scanned[1].ranges_m.empty());
  ASSERT_EQ(bench.scanned[1].inputs.size(), 2u);
  EXPECT_EQ(bench.scanned[1].inputs[1].channel, "ATTACK");

  Bench again(mapping_scenario());
  again.send_frame(Duration{0});
  EXPECT_EQ(again.scanned.at(0).ranges_m, scan.ranges_m) << "the noise depends on the instant only";
  Bench tracker;
  tracker.send_frame(Duration{0});
  EXPECT_TRUE(tracker.scanned.empty());
}

TEST(SensorNode, RefusesAnUnknownRobotAndAZeroStep) {
  bus::InProcessHub hub;
  const auto transport = hub.connect();
  bus::Bus bus(*transport, 1);
  const bus::VirtualClock clock(kStart);
  scenario::Scenario scenario = test::lab_scenario();
  EXPECT_THROW(SensorNode(bus, clock, scenario, "Q9"), UsageError);
  scenario.planner.step_s = 0.0;
  EXPECT_THROW(SensorNode(bus, clock, scenario, "Q1"), UsageError);
}

}  // namespace
}  // namespace vantage::drivers
