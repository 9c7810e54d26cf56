#include "tools/log/range_report.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/estimator/ranges/range_scene.hpp"
#include "test/support/temporary_folder.hpp"
#include "tools/log/log_plot.hpp"

namespace vantage::tools {
namespace {

/// Returns the report of a simulated recording. The position of the first beacon is surveyed; one
/// more beacon has no ranges.
RangeReport drawn_report() {
  const auto scene = estimator::test::draw_range_scene(21, {});
  RangeRecording recording;
  for (std::size_t b = 0; b < scene.beacons_m.size(); ++b) {
    recording.beacons.push_back("it's " + std::to_string(b));
  }
  recording.ranges = scene.ranges;
  for (std::size_t i = 0; i < scene.ranges.size(); ++i) {
    recording.times_s.push_back(0.5 * static_cast<double>(i));
  }
  return report_of(recording, {{"it's 0", scene.beacons_m[0]}, {"far", {0.0, 0.0}}}, 0.7, "drawn");
}

TEST(RangeReport, ComparesWithSurveyAndHeldOutRanges) {
  const RangeReport report = drawn_report();
  ASSERT_TRUE(report.surveys[0].has_value());
  const Eigen::Vector2d error_m = report.fit.beacons[0].position_m - report.surveys[0]->position_m;
  EXPECT_EQ(report.surveys[0]->error_m, error_m.norm());
  EXPECT_FALSE(report.surveys[1].has_value());
  EXPECT_EQ(mean_nees(report), report.surveys[0]->nees);
  EXPECT_EQ(report.not_fitted, std::vector<std::string>{"far"});
  ASSERT_TRUE(report.held_back.has_value());
  EXPECT_NEAR(report.held_back->nees, 1.0, 0.5);
}

TEST(RangeReport, HasTheSameContentInJson) {
  const RangeReport report = drawn_report();
  const nlohmann::ordered_json json = to_json(report);
  EXPECT_EQ(json["range_scale"], report.fit.calibration.range_scale);
  EXPECT_EQ(json["range_bias_sigma_m"], report.fit.range_bias_sigma_m);
  EXPECT_EQ(json["ranges"]["used"], report.recording.ranges.size());
  EXPECT_EQ(json["beacons"].size(), report.fit.beacons.size());
  EXPECT_EQ(json["beacons"][0]["ranges"], 150);
  EXPECT_EQ(json["beacons"][0]["error_m"], report.surveys[0]->error_m);
  EXPECT_FALSE(json["beacons"][1].contains("error_m"));
  EXPECT_EQ(json["mean_nees"], *mean_nees(report));
  const std::vector<std::string> lines = to_lines(report);
  EXPECT_TRUE(lines.back().starts_with("calibration: {range_scale: ")) << lines.back();
}

TEST(RangePlot, IsDrawnByGnuplot) {
  EXPECT_THROW(static_cast<void>(range_plot_script(drawn_report(), "x.docx")), StartupError);
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  const test::TemporaryFolder folder;
  const std::string svg = folder.file("it's a plot.svg");
  const auto drawn = draw_plot(range_plot_script(drawn_report(), svg), folder.file("p.gp"), svg);
  ASSERT_TRUE(drawn.ok()) << drawn.error().message;
  std::ifstream in(svg);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (const char* words : {"survey", "residual, m", "beacon, 95 %"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace vantage::tools
