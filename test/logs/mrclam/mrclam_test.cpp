#include "logs/mrclam/mrclam.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::logs {
namespace {

/// Folder with one robot and one landmark.
struct SmallSet {
  SmallSet() {
    write("Barcodes.dat", "# Subject #    Barcode #\n  1 \t   5\n  6 \t  63\n");
    write("Landmark_Groundtruth.dat", "# head\n  6 \t 0.5 \t -4.25 \t 0.00004 \t 0.00027\n");
    write("Robot1_Odometry.dat", "1248444187.156 \t  0.086 \t -0.398\n");
    write("Robot1_Measurement.dat",
          "1248444189.599 \t  63 \t  3.787 \t -0.257\n1248444189.599 \t  99 \t 1.0 \t 0.1\n");
    write("Robot1_Groundtruth.dat", "1248444175.103 \t 1.4 \t -3.9 \t 4.0\n");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder.file(name)) << text;
  }
  test::TemporaryFolder folder;
};

std::string refusal_of(const SmallSet& set) {
  try {
    static_cast<void>(read_mrclam(set.folder.path()));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Mrclam, ReadsFolder) {
  const SmallSet set;
  const MrclamData data = read_mrclam(set.folder.path());
  ASSERT_EQ(data.landmarks.size(), 1U);
  EXPECT_EQ(data.landmarks[0].subject, 6);
  EXPECT_EQ(data.landmarks[0].position_m, Eigen::Vector2d(0.5, -4.25));
  ASSERT_EQ(data.robots.size(), 1U);
  const MrclamData::Robot& robot = data.robots[0];
  ASSERT_EQ(robot.commands.size(), 1U);
  EXPECT_EQ(to_utime(robot.commands[0].time), 1'248'444'187'156'000);
  EXPECT_EQ(robot.commands[0].turn_radps, -0.398);
  ASSERT_EQ(robot.observations.size(), 2U);
  EXPECT_EQ(robot.observations[0].subject, 6);
  EXPECT_EQ(robot.observations[1].subject, -1);
  ASSERT_EQ(robot.truth.size(), 1U);
  EXPECT_NEAR(robot.truth[0].world_from_body.yaw_rad, 4.0 - 2.0 * 3.14159265358979, 1e-12);
}

TEST(Mrclam, NamesFileLineAndRuleOfInvalidLine) {
  const SmallSet set;
  set.write("Robot1_Odometry.dat", "# head\n1.0 0.1 0.2\n2.0 0.1\n");
  EXPECT_NE(refusal_of(set).find("Robot1_Odometry.dat:3: '2.0 0.1' must consist of 3"),
            std::string::npos)
      << refusal_of(set);
}

TEST(Mrclam, RefusesDamagedFilesWithFileLineAndRule) {
  struct Row {
    const char* file;
    const char* text;
    const char* refusal;
  };
  for (const Row& row : {
           Row{"Robot1_Odometry.dat", "", "Robot1_Odometry.dat: contains no line of numbers"},
           Row{"Robot1_Odometry.dat", "# head\n", "contains no line of numbers"},
           Row{"Robot1_Odometry.dat", "1 0.1 0.2\n2 0.1 nan\n", "Odometry.dat:2: '2 0.1 nan' must"},
           Row{"Robot1_Odometry.dat", "1 0.1 0.2\n2 0.1 0.2 x\n", ":2: '2 0.1 0.2 x' must consist"},
           Row{"Robot1_Odometry.dat", "-1 0.1 0.2\n", ":1: '-1 0.1 0.2' must begin with a time"},
           Row{"Robot1_Odometry.dat", "1 1000 0.2\n", "speed within 100 m/s"},
           // Files whose contents are swapped.
           Row{"Robot1_Odometry.dat", "1 63 3.787 -0.257\n", "another file of the data set"},
           Row{"Robot1_Measurement.dat", "1 1.4 -3.9 4.0\n",
               "must have a bar code, which is a whole"},
           Row{"Robot1_Groundtruth.dat", "1 0.1 0.2\n", "must consist of 4 finite numbers"},
           Row{"Robot1_Groundtruth.dat", "1 20000 0 0\n", "position within 10 km"},
           Row{"Landmark_Groundtruth.dat", "6 63\n", "must consist of 5"},
           Row{"Landmark_Groundtruth.dat", "6.5 0 0 0 0\n", "must begin with a subject"},
           Row{"Barcodes.dat", "1 5.5\n", "which are whole numbers"},
           Row{"Robot3_Odometry.dat", "1 0.1 0.2\n", "Robot2_Odometry.dat: is missing"},
       }) {
    const SmallSet set;
    set.write(row.file, row.text);
    EXPECT_NE(refusal_of(set).find(row.refusal), std::string::npos)
        << row.refusal << " is missing in: " << refusal_of(set);
  }
}

TEST(Mrclam, RefusesMissingFiles) {
  for (const char* file : {"Barcodes.dat", "Landmark_Groundtruth.dat", "Robot1_Odometry.dat",
                           "Robot1_Measurement.dat", "Robot1_Groundtruth.dat"}) {
    const SmallSet set;
    std::filesystem::remove(set.folder.file(file));
    EXPECT_NE(refusal_of(set).find(file), std::string::npos) << refusal_of(set);
  }
}

TEST(Mrclam, SortsLinesByTimeAndCountsThem) {
  const SmallSet set;
  set.write("Robot1_Odometry.dat", "2.0 0.1 0.2\n1.0 0.3 0.2\n3.0 0.1 0.2\n");
  const MrclamData data = read_mrclam(set.folder.path());
  EXPECT_EQ(data.reordered, 1);
  ASSERT_EQ(data.robots[0].commands.size(), 3U);
  EXPECT_EQ(data.robots[0].commands[0].speed_mps, 0.3);
}

TEST(Mrclam, LeavesOutImpossibleObservations) {
  const SmallSet set;
  set.write("Robot1_Measurement.dat", "1 63 -1 0\n1 63 2 7\n1 63 2 0.5\n");
  const MrclamData data = read_mrclam(set.folder.path());
  EXPECT_EQ(data.impossible, 2);
  ASSERT_EQ(data.robots[0].observations.size(), 1U);
  EXPECT_EQ(data.robots[0].observations[0].bearing_rad, 0.5);
}

TEST(Mrclam, RefusesFolderWithoutTheDataSet) {
  EXPECT_THROW(static_cast<void>(read_mrclam("/nonexistent")), StartupError);
}

TEST(Mrclam, ReadsDataSetSix) {
  const char* const folder = std::getenv("VANTAGE_MRCLAM");
  if (folder == nullptr) {
    GTEST_SKIP() << "set VANTAGE_MRCLAM to the folder MRCLAM_Dataset6";
  }
  const MrclamData data = read_mrclam(folder);
  EXPECT_EQ(data.landmarks.size(), 15U);
  ASSERT_EQ(data.robots.size(), 5U);
  std::size_t observations = 0;
  int unknown = 0;
  for (const MrclamData::Robot& robot : data.robots) {
    observations += robot.observations.size();
    for (const MrclamData::Observation& each : robot.observations) {
      unknown += each.subject < 0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(observations), 19'300.0, 100.0);
  EXPECT_EQ(unknown, 6);
}

}  // namespace
}  // namespace vantage::logs
