#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_ros2_yaml.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/lab_text.hpp"

namespace vantage::scenario {
namespace {

/// Returns config/lab.yaml with real mocap, detectors instead of sensors, and `section`.
std::string lab_text(const std::string& section) {
  return test::lab_with(
      {{"  sensor:", "  sensor:\n    device: external\n    #"},
       {"  device: direct             # direct, wire or real, as for robots", "  device: real"},
       {"seed: 1 ", section + "seed: 1 "}});
}

TEST(Ros2Of, ReadsTheSection) {
  const Scenario scenario = parse_scenario(
      lab_text("ros2:\n  domain: 7\n  interface: eth1\n  prefix: /lab\n  world_frame: map\n"
               "  poses:\n"
               "    - {topic: /Q1/pose, body: Q1}\n"
               "    - {topic: /Q2/odom, type: odometry, body: Q2}\n"
               "    - {topic: /mocap/tf, type: tf}\n"
               "  detections:\n"
               "    - {topic: /Q1/detections, robot: Q1}\n"),
      "lab.yaml");
  const auto spec = ros2_of(scenario);
  ASSERT_TRUE(spec);
  EXPECT_EQ(spec->domain, 7);
  EXPECT_EQ(spec->interface, "eth1");
  EXPECT_EQ(spec->prefix, "/lab");
  EXPECT_EQ(spec->world_frame, "map");
  ASSERT_EQ(spec->poses.size(), 3U);
  EXPECT_EQ(spec->poses[0].type, Ros2PoseType::kPose);
  EXPECT_EQ(spec->poses[0].body, "Q1");
  EXPECT_EQ(spec->poses[1].type, Ros2PoseType::kOdometry);
  EXPECT_EQ(spec->poses[2].topic, "/mocap/tf");
  ASSERT_EQ(spec->detections.size(), 1U);
  EXPECT_EQ(spec->detections[0].robot, "Q1");
}

TEST(Ros2Of, IsAbsentWithoutTheSection) {
  EXPECT_FALSE(ros2_of(parse_scenario(lab_text(""), "lab.yaml")));
  EXPECT_FALSE(ros2_of(Scenario{}));
}

// ROS 2 does not sign messages, so security refuses its inputs unless the scenario names them.
TEST(Ros2Of, RequiresTrustForInputsWithSecurity) {
  const std::string section =
      "security: {mode: require, keys: keys}\nros2:\n  poses: [{topic: /a, body: Q1}]\n";
  try {
    static_cast<void>(parse_scenario(lab_text(section), "lab.yaml"));
    FAIL() << "accepted";
  } catch (const StartupError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("topic /a is not signed, but security.mode is "
                        "require: add it to ros2.trusted_topics"),
              std::string::npos)
        << error.what();
  }
  const Scenario trusted =
      parse_scenario(lab_text(section + "  trusted_topics: [/a]\n"), "lab.yaml");
  EXPECT_EQ(ros2_of(trusted)->trusted_topics, std::vector<std::string>{"/a"});
}

}  // namespace
}  // namespace vantage::scenario
