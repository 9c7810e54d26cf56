#include "scenario/reader/localizer_text.hpp"

#include <gtest/gtest.h>

#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::scenario {
namespace {

const std::string kOneRobot = R"(name: team
world:
  bounds: {min_m: [-5, -5], max_m: [5, 5]}
robots:
  - {name: A, start: {x_m: 0, y_m: 0}, primitives: lab, sensor: {kind: range_bearing, range_max_m: 1, range_min_m: 0.1}}
targets: {count: 1, name_prefix: W}
)";

LocalizerSpec full() {
  LocalizerSpec spec;
  spec.landmarks = {{7, {1.25, -3.5}}, {8, {0.000001, 4.0}}};
  spec.unknown_landmarks_max = 9;
  LocalizedRobotSpec& robot = spec.robots.emplace_back();
  robot.name = "A";
  robot.id = 3;
  robot.sightings = {true, 1.0237, 0.171, -0.03125, 0.0625, 0.09375, 0.037};
  robot.drive = {0.156, 0.069, 0.9875, 0.96875, -0.0015};
  spec.odometry_noise = {0.01, 0.02, 0.03, 0.04, 5.0, 0.06, 7.0};
  spec.sighting_noise = {0.01, 0.002, 0.03, 0.04, 0.05, 0.06};
  return spec;
}

TEST(LocalizerText, IsReadAsTheSameValues) {
  const LocalizerSpec spec = full();
  const auto read = parse_localizer(kOneRobot + localizer_text(spec), "x.yaml");
  ASSERT_TRUE(read);
  ASSERT_EQ(read->landmarks.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read->landmarks[k].id, spec.landmarks[k].id);
    EXPECT_LT((read->landmarks[k].position_m - spec.landmarks[k].position_m).norm(), 1e-9);
  }
  EXPECT_EQ(read->unknown_landmarks_max, 9);
  ASSERT_EQ(read->robots.size(), 1U);
  EXPECT_EQ(read->robots[0].name, "A");
  EXPECT_EQ(read->robots[0].id, 3);
  const SightingSpec& s = read->robots[0].sightings;
  EXPECT_TRUE(s.range_is_depth);
  EXPECT_EQ(s.range_scale, 1.0237);
  EXPECT_EQ(s.range_offset_m, 0.171);
  EXPECT_NEAR(s.axis_rad, -0.03125, 1e-6);
  EXPECT_NEAR(s.bearing_offset_rad, 0.0625, 1e-6);
  EXPECT_EQ(s.forward_m, 0.09375);
  EXPECT_EQ(s.stamp_delay_s, 0.037);
  const DriveSpec& d = read->robots[0].drive;
  EXPECT_EQ(d.delay_s, 0.156);
  EXPECT_EQ(d.lag_s, 0.069);
  EXPECT_EQ(d.speed_scale, 0.9875);
  EXPECT_EQ(d.turn_scale, 0.96875);
  EXPECT_EQ(d.turn_bias_radps, -0.0015);
  const OdometryNoiseSpec& o = read->odometry_noise;
  EXPECT_EQ(o.turn_sigma_rad_per_sqrt_s, 0.01);
  EXPECT_EQ(o.turn_sigma_per_sqrt_rad, 0.02);
  EXPECT_EQ(o.slide_sigma_per_sqrt_m, 0.03);
  EXPECT_EQ(o.turn_drift_radps, 0.04);
  EXPECT_EQ(o.turn_drift_time_s, 5.0);
  EXPECT_EQ(o.speed_drift_share, 0.06);
  EXPECT_EQ(o.speed_drift_time_s, 7.0);
  const SightingNoiseSpec& n = read->sighting_noise;
  EXPECT_EQ(n.range_sigma_m, 0.01);
  EXPECT_EQ(n.range_sigma_per_m, 0.002);
  EXPECT_EQ(n.bearing_sigma_rad, 0.03);
  EXPECT_EQ(n.across_sigma_m, 0.04);
  EXPECT_EQ(n.frame_bearing_sigma_rad, 0.05);
  EXPECT_EQ(n.teammate_sigma_m, 0.06);
}

TEST(LocalizerText, IsReadWithoutLandmarks) {
  LocalizerSpec spec = full();
  spec.landmarks.clear();
  const auto read = parse_localizer(kOneRobot + localizer_text(spec), "x.yaml");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->landmarks.empty());
}

}  // namespace
}  // namespace vantage::scenario
