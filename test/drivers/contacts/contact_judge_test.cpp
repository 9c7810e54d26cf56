#include "drivers/contacts/contact_judge.hpp"

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "bus/transport/transport.hpp"
#include "drivers/contacts/app/node.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::drivers {
namespace {

using models::CollisionKind;
using models::FlightState;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr Duration kFrame{20'000};

/// Returns a lab with real vehicles: 4 × 8 m, ceiling 3 m, vehicle radius 0.25 m, separation 0.6 m.
scenario::Scenario real_lab() {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  return scenario;
}

using Placed = std::vector<std::pair<std::string, Eigen::Vector3d>>;

models::MocapFrame frame_of(Time time, const Placed& bodies, std::int64_t run_id = 1) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.stamp.run_id = run_id;
  frame.arrival = time + Duration{5'000};
  for (const auto& [name, centre_m] : bodies) {
    models::MocapBody body;
    body.name = name;
    body.world_from_body.translation_m = centre_m;
    frame.bodies.push_back(body);
  }
  return frame;
}

models::VehicleStatus status_of(const std::string& robot, FlightState state, Time time = kStart) {
  models::VehicleStatus status;
  status.stamp.time = time;
  status.robot = robot;
  status.state = state;
  return status;
}

struct Judged {
  ContactJudge judge;
  Time now = kStart;
  Duration mocap_clock{};  ///< offset of the publisher's clock
  std::int64_t frames = 0;

  explicit Judged(const scenario::Scenario& scenario = real_lab()) : judge(scenario) {}
  void fly(const std::string& robot) {
    judge.on_status(status_of(robot, FlightState::kFollow, now));
  }
  std::vector<models::CollisionReport> see(const Placed& bodies, Duration later = kFrame) {
    now += later;
    models::MocapFrame frame = frame_of(now + mocap_clock, bodies);
    frame.frame_number = ++frames;
    return judge.on_frame(frame, now + Duration{5'000});
  }
  std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& counter : judge.counters()) {
      if (counter.name == name) {
        return counter.count;
      }
    }
    return 0;
  }
};

TEST(ContactJudge, ReportsANearMissAndThenACollisionOfTwoRealVehiclesOnceEach) {
  Judged lab;
  lab.fly("Q1");
  EXPECT_TRUE(lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.61, 4.0, 1.0}}}).empty());
  const auto near = lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.55, 4.0, 1.0}}});
  ASSERT_EQ(near.size(), 1U);
  EXPECT_EQ(near[0].kind, CollisionKind::kNearMiss);
  EXPECT_EQ(near[0].body_a, "Q1");
  EXPECT_EQ(near[0].body_b, "Q2");
  EXPECT_NEAR(near[0].distance_m, 0.05, 1e-9);
  EXPECT_EQ(near[0].stamp.time, lab.now);
  const auto hit = lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.49, 4.0, 1.0}}});
  ASSERT_EQ(hit.size(), 1U);
  EXPECT_EQ(hit[0].kind, CollisionKind::kCollision);
  EXPECT_TRUE(lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.48, 4.0, 1.0}}}).empty());
}

TEST(ContactJudge, ReportsTargetsObstaclesWallsAndUnknownBodies) {
  Judged lab;
  lab.fly("Q1");
  const auto first_of = [&](const Placed& bodies) {
    const auto begun = lab.see(bodies, std::chrono::seconds(1));
    return begun.empty() ? "" : begun.back().body_b;
  };
  EXPECT_EQ(first_of({{"Q1", {2.0, 4.0, 0.4}}, {"ROVER1", {2.0, 4.3, 0.1}}}), "ROVER1");
  EXPECT_EQ(first_of({{"Q1", {1.25, 2.3, 0.4}}}), "obstacle:0");
  EXPECT_EQ(first_of({{"Q1", {0.2, 4.0, 1.0}}}), "bounds");
  EXPECT_EQ(first_of({{"Q1", {2.0, 7.0, 1.0}}, {"HELMET", {2.4, 7.0, 1.0}}}), "HELMET");
}

TEST(ContactJudge, FindsContactsBetweenFrames) {
  Judged lab;
  lab.fly("Q1");
  lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {2.0, 4.0, 1.0}}});
  // The vehicles pass each other between two frames 20 ms apart, so they do not touch in either
  // frame.
  const auto begun = lab.see({{"Q1", {2.0, 4.0, 1.0}}, {"Q2", {1.0, 4.0, 1.0}}});
  ASSERT_FALSE(begun.empty());
  EXPECT_EQ(begun[0].kind, CollisionKind::kCollision);
}

TEST(ContactJudge, DoesNotInterpolateOverGaps) {
  Judged lab;
  lab.fly("Q1");
  lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {2.0, 4.0, 1.0}}});
  EXPECT_TRUE(
      lab.see({{"Q1", {2.0, 4.0, 1.0}}, {"Q2", {1.0, 4.0, 1.0}}}, std::chrono::seconds(1)).empty());
  EXPECT_EQ(lab.count("contacts.gaps"), 1);
  lab.see({{"Q2", {1.0, 4.0, 1.0}}});
  EXPECT_TRUE(lab.see({{"Q1", {0.4, 4.0, 1.0}}, {"Q2", {1.0, 4.0, 1.0}}}).empty());
}

TEST(ContactJudge, IgnoresContactsOfIdleVehicles) {
  Judged lab;
  const Placed together = {{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.1, 4.0, 1.0}}};
  const Placed apart = {{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {2.0, 4.0, 1.0}}};
  EXPECT_TRUE(lab.see(together).empty());
  lab.judge.on_status(status_of("Q1", FlightState::kIdle, lab.now));
  lab.see(apart);
  EXPECT_TRUE(lab.see(together).empty());
  lab.fly("Q1");
  lab.see(apart);
  EXPECT_EQ(lab.see(together).size(), 2U);
  // A killed vehicle is judged while it falls, but not afterwards.
  lab.judge.on_status(status_of("Q1", FlightState::kKilled, lab.now));
  lab.see(apart);
  EXPECT_EQ(lab.see(together).size(), 2U);
  lab.see(apart, ContactJudge::kFall);
  EXPECT_TRUE(lab.see(together).empty());
}

TEST(ContactJudge, IgnoresContactsThatTheSimulatorJudges) {
  scenario::Scenario mixed = real_lab();
  mixed.robots[1].device = scenario::DeviceSource::kDirect;
  mixed.robots[2].device = scenario::DeviceSource::kWire;
  Judged lab(mixed);
  models::TruthFrame truth;
  truth.bodies.resize(1);
  truth.bodies[0].name = "ROVER1";
  lab.judge.on_truth(truth);
  for (const char* const robot : {"Q1", "Q2", "Q3"}) {
    lab.fly(robot);
  }
  EXPECT_TRUE(lab.see({{"Q2", {1.0, 4.0, 1.0}}, {"Q3", {1.1, 4.0, 1.0}}}).empty());
  EXPECT_TRUE(lab.see({{"Q2", {1.0, 4.0, 0.2}}, {"ROVER1", {1.1, 4.0, 0.1}}}).empty());
  EXPECT_TRUE(lab.see({{"Q2", {0.1, 4.0, 1.0}}}).empty());
  // Only this judge reports contacts between a real and a simulated vehicle.
  EXPECT_EQ(lab.see({{"Q1", {3.0, 7.0, 1.0}}, {"Q3", {3.1, 7.0, 1.0}}}).size(), 2U);
}

TEST(ContactJudge, CountsOldFramesAndExcessBodies) {
  Judged lab;
  lab.see({});
  EXPECT_TRUE(lab.judge.on_frame(frame_of(lab.now, {}), lab.now + Duration{5'000}).empty());
  EXPECT_EQ(lab.count("contacts.frames_out_of_order"), 1);
  Placed crowd;
  for (std::size_t i = 0; i < ContactJudge::kOthersMax + 5; ++i) {
    crowd.push_back({std::string("X").append(std::to_string(i)), {2.0, 4.0, 1.0}});
  }
  lab.see(crowd);
  EXPECT_EQ(lab.count("contacts.bodies_left_out"), 5);
  // A new run whose clock is earlier means that the mocap computer was restarted.
  lab.judge.on_frame(frame_of(kStart, {}, 2), kStart + Duration{5'000});
  EXPECT_EQ(lab.count("contacts.gaps"), 1);
}

TEST(ContactJudge, UsesLocalTimeAfterAClockChange) {
  for (const Duration set :
       {Duration{-std::chrono::hours(1)}, Duration{-std::chrono::seconds(1)},
        Duration{-std::chrono::milliseconds(500)}, Duration{std::chrono::hours(1)}}) {
    Judged lab;
    lab.fly("Q1");
    for (const double x_m : {2.0, 1.9, 1.8}) {
      lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {x_m, 4.0, 1.0}}});
    }
    lab.mocap_clock = set;
    lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.7, 4.0, 1.0}}});
    const auto begun = lab.see({{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.4, 4.0, 1.0}}});
    ASSERT_FALSE(begun.empty()) << to_seconds(set);
    EXPECT_NEAR(to_seconds(begun[0].stamp.time - lab.now), 0.0, 0.03) << to_seconds(set);
    EXPECT_EQ(lab.count("contacts.clocks_set"), 1);
    EXPECT_EQ(lab.count("contacts.frames_out_of_order"), 0);
  }
}

TEST(ContactsNode, PublishesItsContactsInAdditionToThoseOfTheSimulator) {
  bus::InProcessHub hub;
  const auto judge_side = hub.connect();
  const auto lab_side = hub.connect();
  const auto sim_side = hub.connect();
  bus::VirtualClock clock(kStart);
  bus::Bus judge_bus(*judge_side, 11);
  bus::Bus lab_bus(*lab_side, 22);
  bus::Bus sim_bus(*sim_side, 33);
  ContactsNode node(judge_bus, clock, real_lab());
  std::vector<models::CollisionReport> received;
  lab_bus.subscribe<models::CollisionReport>(
      bus::kCollision,
      [&](const models::CollisionReport& contact) { received.push_back(contact); });

  lab_bus.publish(bus::vehicle_channel("Q1"), status_of("Q1", FlightState::kHold));
  const Placed together = {{"Q1", {1.0, 4.0, 1.0}}, {"Q2", {1.1, 4.0, 1.0}}};
  clock.set(kStart + Duration{5'000});
  lab_bus.publish(bus::kVicon, frame_of(kStart, together));
  judge_bus.handle(std::chrono::microseconds(0));
  models::CollisionReport simulated;
  simulated.stamp.time = kStart;
  simulated.body_a = "Q3";
  simulated.body_b = "bounds";
  sim_bus.publish(bus::kCollision, simulated);
  clock.set(kStart + kFrame + Duration{5'000});
  lab_bus.publish(bus::kVicon, frame_of(kStart + kFrame, {}));
  judge_bus.handle(std::chrono::microseconds(0));
  clock.set(kStart + 2 * kFrame + Duration{5'000});
  lab_bus.publish(bus::kVicon, frame_of(kStart + 2 * kFrame, {{"Q1", {0.1, 4.0, 1.0}}}));
  judge_bus.handle(std::chrono::microseconds(0));
  while (lab_bus.handle(std::chrono::microseconds(0)) > 0) {
  }
  ASSERT_EQ(received.size(), 4U) << "both publishers are received";
  EXPECT_EQ(received[0].kind, CollisionKind::kCollision);
  EXPECT_EQ(received[1].kind, CollisionKind::kNearMiss);
  EXPECT_EQ(received[2].body_a, "Q3");
  EXPECT_EQ(received[3].body_b, "bounds");
}

}  // namespace
}  // namespace vantage::drivers
