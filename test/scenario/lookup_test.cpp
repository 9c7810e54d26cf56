#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "models/exchange/messages.hpp"
#include "scenario/mocap_spec.hpp"
#include "scenario/scenario.hpp"
#include "scenario/search_name.hpp"

namespace vantage::scenario {
namespace {

TEST(FindRobot, ReturnsTheRobotOrNull) {
  Scenario scenario;
  scenario.robots.resize(2);
  scenario.robots[0].name = "Q1";
  scenario.robots[1].name = "Q2";
  EXPECT_EQ(scenario.find_robot("Q2"), &scenario.robots[1]);
  EXPECT_EQ(scenario.find_robot("Q"), nullptr);
  EXPECT_EQ(scenario.find_robot(""), nullptr);
  EXPECT_EQ(Scenario{}.find_robot("Q1"), nullptr);
}

TEST(RunsOn, IsTrueForTheHostThatNamesThePartElseForTheFirst) {
  Scenario scenario;
  EXPECT_TRUE(scenario.runs_on("LAB", "Q1")) << "without hosts, every part runs on any host";
  scenario.hosts = {{"LAB", {"sim", "Q2"}}, {"AIR", {"Q1"}}};
  EXPECT_TRUE(scenario.runs_on("LAB", "Q2"));
  EXPECT_FALSE(scenario.runs_on("LAB", "Q1"));
  EXPECT_TRUE(scenario.runs_on("AIR", "Q1"));
  EXPECT_TRUE(scenario.runs_on("LAB", kLoggerPart)) << "not assigned to any host";
  EXPECT_FALSE(scenario.runs_on("AIR", kLoggerPart));
  EXPECT_FALSE(scenario.runs_on("ELSE", "Q2"));
}

TEST(FirmwareInstance, IsTheStatedNumberOrTheRobotsIndex) {
  Scenario scenario;
  scenario.robots.resize(4);
  scenario.robots[1].firmware.emplace();
  scenario.robots[2].firmware.emplace().instance = 7;
  scenario.robots[3].firmware.emplace().instance = 0;
  const std::vector<int> expected{0, 1, 7, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scenario.firmware_instance(scenario.robots[i]), expected[i]) << i;
  }
}

TEST(TrialMode, IsDeterminedByTheMostRealDevice) {
  using enum DeviceSource;
  for (const DeviceSource mocap : {kDirect, kWire, kReal}) {
    for (const DeviceSource first : {kDirect, kWire, kReal}) {
      for (const DeviceSource second : {kDirect, kWire, kReal}) {
        Scenario scenario;
        scenario.robots.resize(2);
        scenario.mocap.device = mocap;
        scenario.robots[0].device = first;
        scenario.robots[1].device = second;
        // Sorted: each source is closer to the real device than the previous one.
        const TrialMode expected[] = {TrialMode::kSimulation, TrialMode::kWire, TrialMode::kLive};
        const auto most = static_cast<std::size_t>(std::max({mocap, first, second}));
        EXPECT_EQ(trial_mode(scenario), expected[most]);
      }
    }
  }
  EXPECT_EQ(trial_mode({}), TrialMode::kSimulation);
  EXPECT_STREQ(name_of(TrialMode::kLive), "live");
  EXPECT_STREQ(name_of(TrialMode::kWire), "wire");
  EXPECT_STREQ(name_of(TrialMode::kSimulation), "simulation");
  EXPECT_STREQ(name_of(TrialMode::kReplay), "replay");
}

TEST(MocapProtocol, HasTheStatedNamesAndDefaultPorts) {
  EXPECT_STREQ(MocapProtocol::kDataStream.name(), "datastream");
  EXPECT_STREQ(MocapProtocol::kObjectStream.name(), "object_stream");
  EXPECT_STREQ(MocapProtocol::kVrpn.name(), "vrpn");
  MocapSpec mocap;
  EXPECT_EQ(mocap.actual_port(), 801);
  mocap.protocol = MocapProtocol::kObjectStream;
  EXPECT_EQ(mocap.actual_port(), 51001);
  mocap.protocol = MocapProtocol::kVrpn;
  EXPECT_EQ(mocap.actual_port(), 3883);
  EXPECT_FALSE(mocap.is_y_up());
  mocap.protocol = MocapProtocol::kQtm;
  EXPECT_EQ(mocap.actual_port(), 22223);
  EXPECT_STREQ(mocap.protocol.driver(), "qualisys");
  EXPECT_FALSE(mocap.is_y_up());
  mocap.protocol = MocapProtocol::kNatNet;
  EXPECT_EQ(mocap.actual_port(), 1510);
  EXPECT_STREQ(mocap.protocol.driver(), "natnet");
  EXPECT_TRUE(mocap.is_y_up()) << "the default of Motive";
  mocap.up_axis = UpAxis::kZ;
  EXPECT_FALSE(mocap.is_y_up());
  mocap.port = 1;
  EXPECT_EQ(mocap.actual_port(), 1);
}

TEST(SearchName, IsTheAlgorithmOrMapping) {
  PlannerSpec planner;
  planner.algorithm = "greedy";
  EXPECT_EQ(search_name(planner), "greedy");
  EXPECT_FALSE(is_external(planner));
  planner.objective = PlanObjective::kMapping;
  EXPECT_EQ(search_name(planner), "mapping");
  planner.algorithm = "external";
  EXPECT_EQ(search_name(planner), "external");
  EXPECT_TRUE(is_external(planner));
  planner.objective = PlanObjective::kTracking;
  EXPECT_EQ(search_name(planner), "external");
}

TEST(FindBody, ReturnsTheBodyOrNull) {
  models::MocapFrame frame;
  frame.bodies.resize(2);
  frame.bodies[0].name = "Q1";
  frame.bodies[1].name = "ROVER1";
  EXPECT_EQ(frame.find("ROVER1"), &frame.bodies[1]);
  EXPECT_EQ(frame.find("rover1"), nullptr);
  EXPECT_EQ(models::MocapFrame{}.find("Q1"), nullptr);
}

}  // namespace
}  // namespace vantage::scenario
