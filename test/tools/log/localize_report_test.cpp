#include "tools/log/localize_report.hpp"

#include <gtest/gtest.h>

namespace vantage::tools {
namespace {

localizer::JudgeFigures figures() {
  localizer::JudgeFigures out;
  out.position_m = {10, 0.05, 0.04, 0.09, 0.1};
  out.robot_position_m = {{4, 0.03, 0.02, 0.04, 0.05}, {6, 0.06, 0.05, 0.09, 0.1}};
  out.yaw_rad = {10, 0.01, 0.008, 0.02, 0.03};
  out.nees_position = 2.125;
  out.inside_position = 0.941;
  out.placed_after_s = {0.0, -1.0};
  out.bytes_per_robot_s = 4321.0;
  out.without_pose = 7;
  return out;
}

TEST(LocalizeReport, NamesRobotsAndFigures) {
  std::string text;
  for (const std::string& line : to_lines(figures(), {"A", "B"})) {
    text += line + '\n';
  }
  for (const char* part :
       {"A                0.0300   0.0200   0.0400   0.0500        4", "all robots       0.0500",
        "heading, rad     0.0100", "NEES of position 2.12", "94.1 % inside", "A 0.0 B never",
        "without a pose: 7", "4321 bytes per second"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
  }
}

TEST(LocalizeReport, OmitsBytesWithoutMessages) {
  localizer::JudgeFigures quiet = figures();
  quiet.bytes_per_robot_s = 0.0;
  for (const std::string& line : to_lines(quiet, {"A", "B"})) {
    EXPECT_EQ(line.find("bytes"), std::string::npos);
  }
}

TEST(LocalizeReport, HasTheSameFiguresAsJson) {
  const nlohmann::ordered_json json = to_json(figures(), {"A", "B"});
  EXPECT_EQ(json["position_m"]["rmse"], 0.05);
  EXPECT_EQ(json["robots"][1]["robot"], "B");
  EXPECT_EQ(json["robots"][1]["position_m"]["p95"], 0.09);
  EXPECT_EQ(json["robots"][0]["placed_after_s"], 0.0);
  EXPECT_TRUE(json["robots"][1]["placed_after_s"].is_null());
  EXPECT_EQ(json["nees_position"], 2.125);
}

}  // namespace
}  // namespace vantage::tools
