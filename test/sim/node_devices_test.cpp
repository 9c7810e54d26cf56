// Tests when vantage-sim publishes on the bus, and which devices it simulates.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/convert/channels.hpp"
#include "core/address.hpp"
#include "core/check.hpp"
#include "sim/app/node.hpp"
#include "test/sim/lab_scenario.hpp"
#include "test/support/bus_pair.hpp"
#include "wire/vicon/object_stream.hpp"
#include "wire/vicon/rotation.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

struct Lab {
  explicit Lab(const scenario::Scenario& scenario, Time start = kStart)
      : clock(start), node(net.own, clock, scenario) {
    net.other.subscribe<models::TruthFrame>(bus::kTruth, [this](const models::TruthFrame& truth) {
      truths.push_back(truth.stamp.time);
    });
    net.other.subscribe<models::MocapFrame>(bus::kVicon, [this](const models::MocapFrame& frame) {
      frames.push_back(frame.stamp.time);
      delivered.push_back(clock.now());
    });
    net.other.subscribe<models::VehicleStatus>(
        bus::vehicle_channel("*"),
        [this](const models::VehicleStatus& status) { statuses.push_back(status); });
    net.other.subscribe<models::AttackNotice>(
        bus::kAttack, [this](const models::AttackNotice& notice) {
          attacks.emplace_back(notice.stamp.time - kStart, notice.jammed);
        });
  }
  void tick() {
    net.own.handle(std::chrono::microseconds(0));
    node.tick(clock.now());
    net.other.handle(std::chrono::microseconds(0));
  }
  void run_until(Time end) {
    while (node.next_tick() <= end) {
      clock.set(node.next_tick());
      tick();
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
  bus::VirtualClock clock;
  test::BusPair net{11, 22};
  SimNode node;
  std::vector<Time> truths;
  std::vector<Time> frames;
  std::vector<Time> delivered;
  std::vector<models::VehicleStatus> statuses;
  std::vector<std::pair<Duration, std::vector<std::string>>> attacks;
};

// Started at any time, the node publishes each message at multiples of its period, when the message
// is due.
TEST(SimNode, PublishesAtWholePeriodsForAnyStart) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.rate_hz = 40.0;
  scenario.mocap.latency_s = 0.012;
  Lab lab(scenario, kStart + Duration{1'234});
  lab.run_until(kStart + Duration{212'000});
  const auto every = [](int period_ms, int last_ms) {
    std::vector<Time> out;
    for (int ms = period_ms; ms <= last_ms; ms += period_ms) {
      out.push_back(kStart + Duration{1'000 * ms});
    }
    return out;
  };
  EXPECT_EQ(lab.frames, every(25, 200));
  EXPECT_EQ(lab.truths, every(50, 200));
  for (std::size_t k = 0; k < lab.frames.size(); ++k) {
    EXPECT_EQ(lab.delivered[k], lab.frames[k] + Duration{12'000});
  }
  // The status of each robot is published at the first instant, because the state is new, and then
  // at 10 Hz.
  std::vector<std::pair<std::string, Time>> stamps;
  for (const models::VehicleStatus& status : lab.statuses) {
    stamps.emplace_back(status.robot, status.stamp.time);
  }
  std::vector<std::pair<std::string, Time>> expected;
  for (const int ms : {25, 100, 200}) {
    for (const char* robot : {"Q1", "Q2", "Q3"}) {
      expected.emplace_back(robot, kStart + Duration{1'000 * ms});
    }
  }
  EXPECT_EQ(stamps, expected);
  EXPECT_EQ(lab.node.deadlines_missed(), 0);
  EXPECT_TRUE(lab.node.counters().empty());
  EXPECT_EQ(lab.node.name(), "SIM");
}

TEST(SimNode, PublishesStateChangeAtNextInstant) {
  Lab lab(test::lab_scenario());
  lab.run_until(kStart + Duration{310'000});
  lab.statuses.clear();
  models::OperatorCommand hold;
  hold.stamp.time = lab.clock.now();
  hold.action = models::OperatorAction::kHold;
  hold.robot = "Q2";
  lab.net.other.publish(bus::kCommand, hold);
  lab.run_until(kStart + Duration{390'000});
  ASSERT_EQ(lab.statuses.size(), 1u);
  EXPECT_EQ(lab.statuses[0].robot, "Q2");
  EXPECT_EQ(lab.statuses[0].state, models::FlightState::kHold);
  EXPECT_EQ(lab.statuses[0].stamp.time, kStart + Duration{320'000});
}

TEST(SimNode, PublishesTruthAtMocapRate) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kReal;
  scenario.mocap.rate_hz = 100.0;
  Lab lab(scenario);
  lab.run_until(kStart + Duration{105'000});
  EXPECT_EQ(lab.truths.size(), 11u);
  EXPECT_EQ(lab.truths.back(), kStart + Duration{100'000});
}

// The attack schedule counts from the start of the scenario. Attacks are published on each change
// and once per second.
TEST(SimNode, PublishesAttackOnChangeAndEachSecond) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.attacks = {{0.5, 2.0, {"Q3", "Q1"}}, {1.5, 2.6, {"Q1", "Q2"}}};
  Lab lab(scenario);
  lab.run_until(kStart + Duration{4'900'000});
  using Names = std::vector<std::string>;
  using TimedNotice = std::pair<Duration, Names>;
  const auto at = [](int ms) { return Duration{1'000 * ms}; };
  EXPECT_EQ(lab.attacks, (std::vector<TimedNotice>{{at(0), {}},
                                                   {at(500), {"Q1", "Q3"}},
                                                   {at(1'500), {"Q1", "Q2", "Q3"}},
                                                   {at(2'000), {"Q1", "Q2"}},
                                                   {at(2'600), {}},
                                                   {at(3'600), {}},
                                                   {at(4'600), {}}}));
  Lab quiet(test::lab_scenario());
  quiet.run_until(kStart + Duration{1'500'000});
  EXPECT_TRUE(quiet.attacks.empty());
}

// A tick that is late by one period plus the latency still counts as in time; a microsecond more is
// late.
TEST(SimNode, CountsLateTicksAndCatchesUp) {
  Lab lab(test::lab_scenario());
  lab.run_until(kStart + Duration{1'000'000});
  const Time due = lab.node.next_tick();
  lab.clock.set(due + Duration{20'000});
  lab.tick();
  EXPECT_EQ(lab.node.deadlines_missed(), 0);
  const Time next = lab.node.next_tick();
  lab.clock.set(next + Duration{20'001});
  lab.tick();
  EXPECT_EQ(lab.node.deadlines_missed(), 1);
  EXPECT_EQ(lab.count("sim.late_ticks"), 1);
  EXPECT_EQ(lab.count("sim.catch_up_chunks"), 0);
  // One second has 50 mocap frames, 10 truth messages and 10 statuses, each at its own instant.
  lab.clock.set(lab.clock.now() + Duration{1'000'000});
  lab.frames.clear();
  lab.truths.clear();
  lab.tick();
  EXPECT_EQ(lab.count("sim.catch_up_chunks"), 1);
  std::vector<Time> instants = lab.frames;
  instants.insert(instants.end(), lab.truths.begin(), lab.truths.end());
  std::sort(instants.begin(), instants.end());
  instants.erase(std::unique(instants.begin(), instants.end()), instants.end());
  EXPECT_EQ(instants.size(), 20u);
  EXPECT_EQ(lab.node.next_tick(), lab.clock.now() + Duration{1'000})
      << "the bus is handled meanwhile";
  for (int k = 0; k < 3; ++k) {
    lab.tick();
  }
  EXPECT_EQ(lab.count("sim.catch_up_chunks"), 2) << "at most 60 instants per call";
  EXPECT_GT(lab.node.next_tick(), lab.clock.now());
}

TEST(SimNode, CountsRefusedPlansByReason) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[2].device = scenario::DeviceSource::kReal;
  Lab lab(scenario);
  const auto plan_of = [&](std::size_t robot, Time start) {
    models::RobotPlan plan;
    plan.robot = scenario.robots[robot].name;
    plan.stamp.time = start;
    plan.trajectory = {start,
                       scenario.robots[robot].start,
                       scenario.robots[robot].height_m,
                       {{{0.0, 0.0}, 1.0, 0.0}}};
    plan.horizon_steps = 1;
    plan.slot_start = plan.deadline = plan.finish = start;
    return plan;
  };
  const Time begin = kStart + Duration{1'000'000};
  lab.net.other.publish(bus::plan_channel("Q1"), plan_of(0, begin));
  for (int k = 0; k < 3; ++k) {
    lab.net.other.publish(bus::plan_channel("Q1"), plan_of(0, begin - Duration{1}));
  }
  lab.net.other.publish(bus::plan_channel("Q3"), plan_of(2, begin));  // Q3 is a real robot
  for (int k = 0; k < 2; ++k) {
    models::RobotPlan far = plan_of(1, begin);
    far.trajectory.start.x_m += 3.0;
    lab.net.other.publish(bus::plan_channel("Q2"), far);
  }
  lab.net.other.publish(bus::plan_channel("Q2"), plan_of(0, begin));
  lab.run_until(kStart + Duration{100'000});
  std::vector<std::pair<std::string, std::int64_t>> counted;
  for (const models::NamedCount& counter : lab.node.counters()) {
    counted.emplace_back(counter.name, counter.count);
  }
  EXPECT_EQ(
      counted,
      (std::vector<std::pair<std::string, std::int64_t>>{
          {"sim.plans_discontinuous", 2}, {"sim.plans_stale", 3}, {"sim.plans_misaddressed", 1}}));
}

TEST(SimNode, NamesTheDeviceThatRequiresRealTime) {
  const auto why = [](const scenario::Scenario& scenario) {
    try {
      const Lab lab(scenario);
    } catch (const StartupError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string cure =
      "has device 'wire', which needs real time: run it with `vantage up`, or set device: direct";
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[1].device = scenario::DeviceSource::kWire;
  EXPECT_EQ(why(scenario), "robot Q2 " + cure);
  scenario = test::lab_scenario();
  scenario.mocap.device = scenario::DeviceSource::kWire;
  EXPECT_EQ(why(scenario), "mocap " + cure);
}

/// A socket that receives datagrams on its own port.
class UdpReceiver {
 public:
  UdpReceiver() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = address_of(INADDR_LOOPBACK, 0);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(fd_, as_sockaddr(address), size), 0);
    EXPECT_EQ(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port = ntohs(address.sin_port);
  }
  ~UdpReceiver() { close(fd_); }
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;
  UdpReceiver(UdpReceiver&&) = delete;
  UdpReceiver& operator=(UdpReceiver&&) = delete;
  std::vector<std::uint8_t> read_reply() {
    std::vector<std::uint8_t> out(4096);
    const ssize_t got = recv(fd_, out.data(), out.size(), MSG_DONTWAIT);
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return out;
  }
  int port = 0;

 private:
  int fd_;
};

/// A clock that reports real time, but advances only when the test sets it.
class StandingClock : public bus::Clock {
 public:
  [[nodiscard]] Time now() const override { return time; }
  [[nodiscard]] bool is_real_time() const override { return true; }
  Time time = kStart;
};

TEST(SimNode, ServesMocapOnTheWire) {
  for (const bool is_y_up : {false, true}) {
    UdpReceiver receiver;
    scenario::Scenario scenario = test::lab_scenario();
    scenario.mocap.device = scenario::DeviceSource::kWire;
    scenario.mocap.protocol = scenario::MocapProtocol::kObjectStream;
    scenario.mocap.port = receiver.port;
    scenario.mocap.block_bytes = 1024;
    scenario.mocap.position_sigma_m = 0.0;
    scenario.mocap.up_axis = is_y_up ? scenario::UpAxis::kY : scenario::UpAxis::kAsTold;
    StandingClock clock;
    test::BusPair net(11, 22);
    SimNode node(net.own, clock, scenario);
    clock.time = kStart + Duration{4'999};
    node.tick(clock.time);
    EXPECT_TRUE(receiver.read_reply().empty()) << "the latency has not passed yet";
    EXPECT_EQ(node.next_tick(), kStart + Duration{5'999}) << "a pause, then the latency";
    clock.time = kStart + Duration{6'000};
    node.tick(clock.time);
    const std::vector<std::uint8_t> datagram = receiver.read_reply();
    EXPECT_EQ(datagram.size(), 1024u);
    wire::vicon::ObjectBlock block;
    ASSERT_TRUE(wire::vicon::decode_object_block(datagram, block));
    ASSERT_EQ(block.objects.size(), 8u);
    EXPECT_EQ(block.frame_number, static_cast<std::uint32_t>(to_utime(kStart) / 20'000));
    EXPECT_EQ(block.objects[1].name(), "Q2");
    Pose3 pose{1e-3 * block.objects[1].translation_mm,
               wire::vicon::rotation_from_euler_xyz(block.objects[1].euler_xyz_rad)};
    pose = is_y_up ? wire::vicon::z_up_from_y_up(pose) : pose;
    EXPECT_LT((pose.translation_m - Eigen::Vector3d(2.0, 1.0, 1.5)).norm(), 1e-6);
    EXPECT_TRUE(node.counters().empty());
    EXPECT_EQ(node.deadlines_missed(), 0);
  }
}

// With vehicles connected by wire, the simulated world follows the clock, and frames are sent after
// their latency.
TEST(SimNode, FollowsTheClockForWireVehicles) {
  UdpReceiver receiver;
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[1].device = scenario::DeviceSource::kWire;
  scenario.robots[1].autopilot.emplace();
  scenario.robots[1].autopilot->url = "udp://127.0.0.1:" + std::to_string(receiver.port);
  StandingClock clock;
  test::BusPair net(11, 22);
  std::vector<models::MocapFrame> frames;
  std::vector<Time> delivered;
  net.other.subscribe<models::MocapFrame>(bus::kVicon, [&](const models::MocapFrame& frame) {
    frames.push_back(frame);
    delivered.push_back(clock.time);
  });
  SimNode node(net.own, clock, scenario);
  std::vector<Time> ticks;
  for (int k = 0; k < 20; ++k) {
    clock.time = node.next_tick();
    ticks.push_back(clock.time);
    node.tick(clock.time);
    net.other.handle(std::chrono::microseconds(0));
    if (k > 0) {  // the first frame follows a pause after the start
      EXPECT_EQ(node.world().time(), clock.time);
    }
  }
  for (std::size_t k = 2; k < ticks.size(); ++k) {
    EXPECT_EQ(ticks[k] - ticks[k - 1], Duration{5'000});
  }
  ASSERT_EQ(frames.size(), 5u);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(delivered[k] - frames[k].stamp.time, Duration{5'000});
  }
  EXPECT_EQ(frames[0].bodies[1].name, "Q2");
  EXPECT_NEAR(frames[0].bodies[1].world_from_body.translation_m.z(), 0.0, 0.01)
      << "stationary on the ground";
  EXPECT_NEAR(frames[0].bodies[0].world_from_body.translation_m.z(), 1.0, 0.01);
  EXPECT_FALSE(receiver.read_reply().empty()) << "its autopilot sends messages";
}

}  // namespace
}  // namespace vantage::sim
