#include "tools/log/team_recording.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "logs/mrclam/mrclam_log.hpp"
#include "logs/record/log_writer.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::tools {
namespace {

/// Folder of a data set with two robots and one landmark.
struct SmallSet {
  SmallSet() {
    write("Barcodes.dat", "1 5\n2 14\n6 63\n");
    write("Landmark_Groundtruth.dat", "6 0.5 -4.25 0.00004 0.00027\n");
    for (const char* robot : {"Robot1_", "Robot2_"}) {
      write(robot + std::string("Odometry.dat"),
            "100.010 0.1 -0.4\n100.020 0.1 -0.4\n100.300 0.2 0.0\n");
      write(robot + std::string("Measurement.dat"),
            "100.020 63 3.5 -0.25\n100.020 99 1.0 0.1\n100.250 63 3.25 -0.125\n");
      write(robot + std::string("Groundtruth.dat"), "100.0 1.5 -3.5 3.0\n100.1 1.75 -3.5 -3.0\n");
    }
    write("Robot2_Groundtruth.dat", "100.1 2.5 -1.5 0.5\n100.2 2.75 -1.5 0.5\n");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder.file(name)) << text;
  }
  /// Writes the data set as a log and returns its path.
  [[nodiscard]] std::string imported() const {
    const std::string path = folder.file("small.lcmlog");
    logs::LogWriter log(path, logs::Existing::kReplace);
    logs::write_mrclam(
        logs::read_mrclam(folder.path()), "1.2.3",
        [&](const logs::LogEvent& event) {
          return log.write(event.time, event.channel, event.data);
        },
        [] { return false; });
    EXPECT_FALSE(log.close());
    return path;
  }
  test::TemporaryFolder folder;
};

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const StartupError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(TeamRecording, IsTheSameFromLogAndFolder) {
  const SmallSet set;
  const TeamRecording a = read_team(set.folder.path());
  const TeamRecording b = read_team(set.imported());
  ASSERT_EQ(a.recording.size(), 2U);
  ASSERT_EQ(b.recording.size(), 2U);
  EXPECT_EQ(a.yaml, b.yaml);
  ASSERT_EQ(b.spec.landmarks.size(), 1U);
  EXPECT_EQ(b.spec.landmarks[0].position_m, a.spec.landmarks[0].position_m);
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(a.spec.robots[r].name, b.spec.robots[r].name);
    EXPECT_EQ(a.spec.robots[r].id, b.spec.robots[r].id);
    const localizer::RobotRecording& x = a.recording[r];
    const localizer::RobotRecording& y = b.recording[r];
    ASSERT_EQ(x.odometry.size(), y.odometry.size());
    for (std::size_t i = 0; i < x.odometry.size(); ++i) {
      EXPECT_EQ(x.odometry[i].stamp.time, y.odometry[i].stamp.time);
      EXPECT_EQ(x.odometry[i].motion_body, y.odometry[i].motion_body);
    }
    ASSERT_EQ(x.frames.size(), y.frames.size());
    for (std::size_t i = 0; i < x.frames.size(); ++i) {
      EXPECT_EQ(x.frames[i].stamp, y.frames[i].stamp);
      ASSERT_EQ(x.frames[i].sightings.size(), y.frames[i].sightings.size());
      for (std::size_t k = 0; k < x.frames[i].sightings.size(); ++k) {
        EXPECT_EQ(x.frames[i].sightings[k].id, y.frames[i].sightings[k].id);
        EXPECT_EQ(x.frames[i].sightings[k].range_m, y.frames[i].sightings[k].range_m);
      }
    }
    EXPECT_EQ(x.truth.begin(), y.truth.begin());
    EXPECT_EQ(x.truth.end(), y.truth.end());
    const Pose2 from = *x.truth.at(x.truth.begin());
    const Pose2 to = *y.truth.at(y.truth.begin());
    EXPECT_EQ(from.position_m(), to.position_m());
    EXPECT_NEAR(from.yaw_rad, to.yaw_rad, 1e-12);
  }
}

TEST(TeamRecording, PutsSightingsWithTheSameStampIntoOneFrame) {
  const SmallSet set;
  const TeamRecording team = read_team(set.imported());
  ASSERT_EQ(team.recording[0].frames.size(), 2U);
  ASSERT_EQ(team.recording[0].frames[0].sightings.size(), 2U);
  EXPECT_EQ(team.recording[0].frames[0].sightings[0].id, 6);
  EXPECT_EQ(team.recording[0].frames[0].sightings[1].id, -1);
  EXPECT_EQ(to_utime(team.recording[0].frames[0].stamp), 100'020'000);
}

TEST(TeamRecording, EventsOfImportedLogAscendInTimeAfterScenario) {
  const SmallSet set;
  const logs::IndexedLog log(set.imported());
  logs::LogScan scan = log.scan();
  Time newest = Time::min();
  std::vector<std::string> channels;
  while (const auto event = scan.next()) {
    EXPECT_GE(event->time, newest);
    newest = event->time;
    channels.emplace_back(event->channel);
  }
  // Poses at three times; three commands and two frames of each robot.
  ASSERT_EQ(channels.size(), 1U + 3U + 6U + 4U);
  EXPECT_EQ(channels.front(), "SCENARIO");
  EXPECT_EQ(to_utime(newest), 100'300'000);
}

TEST(TeamRecording, ScenarioOfImportedLogIsValid) {
  const SmallSet set;
  const TeamRecording team = read_team(set.folder.path());
  const scenario::Scenario scenario = scenario::parse_scenario(team.yaml, "x.yaml");
  EXPECT_EQ(scenario.robots.size(), 2U);
  EXPECT_TRUE(scenario.world.bounds.contains({0.5, -4.25}));
}

TEST(TeamRecording, ReplacesParametersButKeepsLandmarks) {
  const SmallSet set;
  TeamRecording team = read_team(set.folder.path());
  std::string yaml = team.yaml;
  yaml.replace(yaml.find("range_scale: 1"), 14, "range_scale: 1.25");
  yaml.replace(yaml.find("x_m: 0.500000"), 13, "x_m: 0.250000");
  set.write("fitted.yaml", yaml);
  use_parameters(set.folder.file("fitted.yaml"), team);
  EXPECT_EQ(team.spec.robots[0].sightings.range_scale, 1.25);
  EXPECT_EQ(team.spec.robots[1].sightings.range_scale, 1.0);
  EXPECT_EQ(team.spec.landmarks[0].position_m.x(), 0.5);
}

TEST(TeamRecording, RefusesParametersOfAnotherTeam) {
  const SmallSet set;
  TeamRecording team = read_team(set.folder.path());
  set.write("fitted.yaml", team.yaml);
  team.spec.robots[1].name = "R9";
  const std::string why = refusal_of([&] { use_parameters(set.folder.file("fitted.yaml"), team); });
  EXPECT_NE(why.find("does not contain robot R9"), std::string::npos) << why;
}

TEST(TeamRecording, RefusesRobotWithoutTruth) {
  const SmallSet set;
  TeamRecording team = read_team(set.folder.path());
  team.recording[1].truth = {};
  const std::string why = refusal_of([&] { require_truth(team); });
  EXPECT_NE(why.find("no true pose of robot R2"), std::string::npos) << why;
}

}  // namespace
}  // namespace vantage::tools
