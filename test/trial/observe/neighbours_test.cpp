#include "trial/observe/neighbours.hpp"

#include <gtest/gtest.h>

#include "bus/node/bus.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::trial {
namespace {

using Channels = std::set<std::string>;

scenario::Scenario lab() { return scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml"); }
scenario::Scenario lab_of_two_hosts() {
  scenario::Scenario scenario = lab();
  scenario.hosts = {{"LAB", {scenario::kSimPart, scenario::kLoggerPart, "Q1"}},
                    {"AIR", {"Q2", "Q3"}}};
  return scenario;
}

TEST(RivalsOfUp, AreSupervisorsSimulatorsAndVehiclesOfAnotherTrial) {
  const scenario::Scenario scenario = lab();
  EXPECT_TRUE(rivals_of_up(scenario, "", {}).empty());
  EXPECT_TRUE(rivals_of_up(scenario, "", Channels{"COMMAND", "VICON", "HEALTH_VIEW"}).empty());
  EXPECT_EQ(rivals_of_up(scenario, "", Channels{"HOST_LOCAL"}).size(), 1U);
  EXPECT_EQ(rivals_of_up(scenario, "", Channels{"TRUTH"}).size(), 1U);
  EXPECT_EQ(rivals_of_up(scenario, "", Channels{"VEHICLE_Q1", "VEHICLE_X"}).size(), 2U);
  EXPECT_EQ(rivals_of_up(scenario, "", Channels{"QUADROTOR_Q1"}).size(), 1U)
      << "of a version before";
}

TEST(RivalsOfUp, AreNotTheOtherHostsOfTheTrial) {
  const scenario::Scenario scenario = lab_of_two_hosts();
  const Channels of_lab{"HOST_LAB", "TRUTH", "VICON", "VEHICLE_Q1", "VEHICLE_Q2"};
  EXPECT_TRUE(rivals_of_up(scenario, "AIR", of_lab).empty());
  EXPECT_TRUE(rivals_of_up(scenario, "LAB", Channels{"HOST_AIR", "PLAN_Q2"}).empty());
  EXPECT_EQ(rivals_of_up(scenario, "LAB", of_lab).size(), 2U) << "the same host, its simulator";
  EXPECT_EQ(rivals_of_up(scenario, "AIR", Channels{"HOST_LOCAL"}).size(), 1U);
  EXPECT_EQ(rivals_of_up(scenario, "AIR", Channels{"VEHICLE_X"}).size(), 1U);
  EXPECT_EQ(rivals_of_up(scenario, "", Channels{"HOST_AIR"}).size(), 1U) << "with --all-hosts";
}

TEST(RivalsOfUp, AreVehiclesThatItWouldFlyItself) {
  scenario::Scenario scenario = lab_of_two_hosts();
  for (scenario::RobotSpec& robot : scenario.robots) {
    robot.device = scenario::DeviceSource::kReal;
  }
  EXPECT_EQ(rivals_of_up(scenario, "AIR", Channels{"VEHICLE_Q1", "VEHICLE_Q2"}).size(), 1U);
}

TEST(RivalsOfPlay, AreAllThatALogMightBeTakenFor) {
  EXPECT_TRUE(rivals_of_play(Channels{"HEALTH_VIEW", "COMMAND"}).empty());
  EXPECT_EQ(rivals_of_play(Channels{"VEHICLE_Q1", "HOST_LAB", "TRUTH"}).size(), 3U);
}

TEST(HearChannels, KnowsWhoSpeaks) {
  bus::InProcessHub hub;
  const auto listens = hub.connect();
  const auto speaks = hub.connect();
  int asked = 0;
  const auto stop = [&] {
    speaks->publish("TRUTH", {});
    speaks->publish("HOST_LAB", {});
    return ++asked > 3;
  };
  EXPECT_EQ(hear_channels(*listens, std::chrono::hours(1), stop), (Channels{"HOST_LAB", "TRUTH"}));
}

}  // namespace
}  // namespace vantage::trial
