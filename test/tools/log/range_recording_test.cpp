#include "tools/log/range_recording.hpp"

#include <algorithm>
#include <filesystem>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/write_file.hpp"
#include "test/support/temporary_folder.hpp"
#include "tools/log/range_report.hpp"

namespace vantage::tools {
namespace {

using Rows = std::vector<TableRow>;

/// Returns the poses of a robot at x = t for ten seconds: one per second, but none between 4 s and
/// 7 s.
Rows way() {
  Rows out;
  for (const double t : {0.0, 1.0, 2.0, 3.0, 4.0, 7.0, 8.0, 9.0, 10.0}) {
    out.push_back({"", {t, t, 0.0}});
  }
  return out;
}

Rows ranges_of(const std::string& beacon, int count) {
  Rows out;
  for (int k = 0; k < count; ++k) {
    out.push_back({beacon, {0.25 + 0.1 * k, 5.0}});
  }
  return out;
}

TEST(PlaceRanges, InterpolatesPosesAndCountsOmittedRanges) {
  Rows rows = ranges_of("A", 12);
  rows.push_back({"A", {-0.5, 5.0}});  // before the first pose
  rows.push_back({"A", {10.5, 5.0}});  // after the last pose
  rows.push_back({"A", {5.0, 5.0}});   // in the gap
  rows.push_back({"A", {7.0, 5.0}});   // at the pose next to the gap
  rows.push_back({"A", {0.25, 5.0}});  // a duplicate
  rows.push_back({"A", {0.25, 5.5}});  // at the same time, with another range
  rows.push_back({"A", {0.0, 5.0}});   // at the first pose
  rows.push_back({"A", {10.0, 5.0}});  // at the last pose
  Table table{rows, 2, true};
  Table poses{way(), 1, false};
  poses.rows.push_back({"", {3.0, 99.0, 99.0}});  // same time as the pose before it
  const RangeRecording recording = place_ranges(table, poses, 1.0);
  EXPECT_EQ(recording.ranges.size(), 16u);
  EXPECT_EQ(recording.not_finite, 3);
  EXPECT_EQ(recording.outside_poses, 2);
  EXPECT_EQ(recording.in_gaps, 1);
  EXPECT_EQ(recording.doubled, 1);
  EXPECT_EQ(recording.poses_left_out, 2);
  for (std::size_t i = 0; i < recording.ranges.size(); ++i) {
    EXPECT_NEAR(recording.ranges[i].robot_m.x(), recording.times_s[i], 1e-9);
    EXPECT_EQ(recording.ranges[i].robot_m.y(), 0.0);
  }
  EXPECT_TRUE(std::is_sorted(recording.times_s.begin(), recording.times_s.end()));
}

TEST(PlaceRanges, IsIndependentOfRowOrder) {
  Rows rows = ranges_of("A", 30);
  Rows poses = way();
  const RangeRecording sorted = place_ranges({rows, 0, false}, {poses, 0, false}, 1.0);
  std::mt19937 rng(3);
  std::shuffle(rows.begin(), rows.end(), rng);
  std::shuffle(poses.begin(), poses.end(), rng);
  const RangeRecording shuffled = place_ranges({rows, 0, false}, {poses, 0, false}, 1.0);
  EXPECT_EQ(sorted.times_s, shuffled.times_s);
  ASSERT_EQ(sorted.ranges.size(), shuffled.ranges.size());
  for (std::size_t i = 0; i < sorted.ranges.size(); ++i) {
    EXPECT_EQ(sorted.ranges[i].robot_m, shuffled.ranges[i].robot_m);
  }
}

TEST(PlaceRanges, DetectsGapRelativeToUsualInterval) {
  Rows poses;
  for (int k = 0; k < 20; ++k) {
    poses.push_back({"", {2.5 * k, 0.0, 0.0}});
  }
  poses.push_back({"", {100.0, 0.0, 0.0}});
  Rows rows = ranges_of("A", 20);
  rows.push_back({"A", {70.0, 5.0}});
  EXPECT_EQ(place_ranges({rows, 0, false}, {poses, 0, false}, {}).in_gaps, 1);
  EXPECT_EQ(place_ranges({rows, 0, false}, {poses, 0, false}, 60.0).in_gaps, 0);
  EXPECT_EQ(place_ranges({rows, 0, false}, {poses, 0, false}, 2.0).in_gaps, 21);
}

TEST(PlaceRanges, OrdersBeaconsAndOmitsThoseWithFewRanges) {
  Rows rows;
  for (const char* beacon : {"10", "9", "north", "2"}) {
    const Rows more = ranges_of(beacon, 15);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  const Rows few = ranges_of("3", 9);
  rows.insert(rows.end(), few.begin(), few.end());
  const RangeRecording recording = place_ranges({rows, 0, false}, {way(), 0, false}, 1.0);
  EXPECT_EQ(recording.beacons, (std::vector<std::string>{"2", "9", "10", "north"}));
  EXPECT_EQ(recording.too_few, std::vector<std::string>{"3"});
  EXPECT_EQ(recording.of_too_few, 9);
  EXPECT_EQ(recording.ranges.size(), 60u);
}

TEST(ReportOf, ExplainsDroppedRangesWhenNoneRemain) {
  const RangeRecording recording =
      place_ranges({ranges_of("A", 9), 4, false}, {way(), 0, false}, 1.0);
  try {
    report_of(recording, {}, 0.7, "r.csv");
    FAIL();
  } catch (const StartupError& error) {
    EXPECT_STREQ(
        error.what(),
        "r.csv: no beacon has 10 usable ranges (left out: 4 with a missing value, 9 of beacons "
        "with too few ranges)");
  }
}

TEST(ReadSurvey, RefusesADuplicateBeacon) {
  const test::TemporaryFolder folder;
  write_file(folder.file("s.csv"), "beacon_id,x_m,y_m\n1,0,0\n1,2,3\n");
  EXPECT_THROW(read_survey(folder.file("s.csv")), StartupError);
}

// The ranges of real radios (Djugash, Hamner, Roth 2009) are 6.9 % too long.
TEST(FitRangesOfPlaza, FindsScaleAndBeacons) {
  const std::string folder = VANTAGE_DATA_DIR "/plaza1/";
  std::error_code error;
  if (!std::filesystem::exists(folder + "ranges.csv", error)) {
    GTEST_SKIP() << "no data in " << folder;
  }
  const RangeReport report = report_of(
      place_ranges(read_ranges(folder + "ranges.csv"), read_poses(folder + "groundtruth.csv"), {}),
      read_survey(folder + "beacons.csv"), 0.7, folder);
  for (const std::string& line : to_lines(report)) {
    fmt::print("{}\n", line);
  }
  EXPECT_NEAR(report.fit.calibration.range_scale, 1.069, 0.003);
  EXPECT_LT(report.fit.range_scale_sigma, 0.0015);
  EXPECT_LT(report.fit.range_bias_sigma_m, 0.2);
  EXPECT_NEAR(report.fit.calibration.range_bias_m, 0.0, 3.0 * report.fit.range_bias_sigma_m);
  ASSERT_EQ(report.fit.beacons.size(), 4u);
  EXPECT_TRUE(report.not_fitted.empty());
  for (std::size_t b = 0; b < 4; ++b) {
    ASSERT_TRUE(report.surveys[b].has_value());
    EXPECT_LT(report.surveys[b]->error_m, 0.15);
    EXPECT_GT(report.fit.beacons[b].probability, 0.99);
  }
  // χ² of four beacons with two coordinates: eight degrees of freedom, below 0.21 with probability
  // 0.001.
  EXPECT_LT(mean_nees(report).value(), 3.0);
  EXPECT_GT(mean_nees(report).value(), 0.2);
  ASSERT_TRUE(report.held_back.has_value());
  EXPECT_GT(report.held_back->inliers, 1000);
  EXPECT_NEAR(report.held_back->nees, 1.0, 0.25);
}

}  // namespace
}  // namespace vantage::tools
