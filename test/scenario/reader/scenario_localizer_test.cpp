#include <string>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::scenario {
namespace {

const std::string kTeam =
    "name: x\n"
    "world: {bounds: {min_m: [0, 0], max_m: [10, 8]}}\n"
    "targets: {count: 1}\n"
    "robot_defaults: {primitives: lab, sensor: {kind: range}}\n"
    "robots: [{name: A, start: {x_m: 2, y_m: 2}}, {name: B, start: {x_m: 5, y_m: 5}}]\n";

std::string refusal_of(const std::string& localizer) {
  try {
    static_cast<void>(parse_localizer(kTeam + localizer, "x.yaml"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(LocalizerScenario, IsAbsentByDefault) { EXPECT_FALSE(parse_localizer(kTeam, "x.yaml")); }

TEST(LocalizerScenario, ReadsEveryKey) {
  const auto spec = parse_localizer(kTeam + R"(
localizer:
  landmarks: [{id: 6, x_m: 1.5, y_m: -2.5}, {id: 7, x_m: 0, y_m: 1}]
  robots:
    - name: A
      id: 1
      sightings: {range_is_depth: true, range_scale: 1.02, range_offset_m: 0.1, axis_rad: 0.03,
                  bearing_offset_rad: -0.02, forward_m: 0.09, stamp_delay_s: 0.04}
      drive: {delay_s: 0.15, lag_s: 0.1, speed_scale: 0.98, turn_scale: 0.96,
              turn_bias_radps: -0.002}
    - {name: B, id: 2}
  odometry_noise: {turn_sigma_rad_per_sqrt_s: 0.1, turn_sigma_per_sqrt_rad: 0.2,
                   slide_sigma_per_sqrt_m: 0.3, turn_drift_radps: 0.4, turn_drift_time_s: 5,
                   speed_drift_share: 0.6, speed_drift_time_s: 7}
  sighting_noise: {range_sigma_m: 0.1, range_sigma_per_m: 0.2, bearing_sigma_rad: 0.3,
                   across_sigma_m: 0.4, frame_bearing_sigma_rad: 0.5, teammate_sigma_m: 0.6}
)",
                                    "x.yaml");
  ASSERT_TRUE(spec);
  ASSERT_EQ(spec->landmarks.size(), 2U);
  EXPECT_EQ(spec->landmarks[0].id, 6);
  EXPECT_EQ(spec->landmarks[0].position_m, Eigen::Vector2d(1.5, -2.5));
  ASSERT_EQ(spec->robots.size(), 2U);
  const SightingSpec& sightings = spec->robots[0].sightings;
  EXPECT_TRUE(sightings.range_is_depth);
  EXPECT_EQ(sightings.range_scale, 1.02);
  EXPECT_EQ(sightings.range_offset_m, 0.1);
  EXPECT_EQ(sightings.axis_rad, 0.03);
  EXPECT_EQ(sightings.bearing_offset_rad, -0.02);
  EXPECT_EQ(sightings.forward_m, 0.09);
  EXPECT_EQ(sightings.stamp_delay_s, 0.04);
  const DriveSpec& drive = spec->robots[0].drive;
  EXPECT_EQ(drive.delay_s, 0.15);
  EXPECT_EQ(drive.lag_s, 0.1);
  EXPECT_EQ(drive.speed_scale, 0.98);
  EXPECT_EQ(drive.turn_scale, 0.96);
  EXPECT_EQ(drive.turn_bias_radps, -0.002);
  EXPECT_FALSE(spec->robots[1].sightings.range_is_depth);
  const OdometryNoiseSpec& odometry = spec->odometry_noise;
  EXPECT_EQ(odometry.turn_sigma_rad_per_sqrt_s, 0.1);
  EXPECT_EQ(odometry.turn_sigma_per_sqrt_rad, 0.2);
  EXPECT_EQ(odometry.slide_sigma_per_sqrt_m, 0.3);
  EXPECT_EQ(odometry.turn_drift_radps, 0.4);
  EXPECT_EQ(odometry.turn_drift_time_s, 5.0);
  EXPECT_EQ(odometry.speed_drift_share, 0.6);
  EXPECT_EQ(odometry.speed_drift_time_s, 7.0);
  const SightingNoiseSpec& noise = spec->sighting_noise;
  EXPECT_EQ(noise.range_sigma_m, 0.1);
  EXPECT_EQ(noise.range_sigma_per_m, 0.2);
  EXPECT_EQ(noise.bearing_sigma_rad, 0.3);
  EXPECT_EQ(noise.across_sigma_m, 0.4);
  EXPECT_EQ(noise.frame_bearing_sigma_rad, 0.5);
  EXPECT_EQ(noise.teammate_sigma_m, 0.6);
}

TEST(LocalizerScenario, ReadsTheSimulationAndTheSafetyRules) {
  const auto spec = parse_localizer(kTeam + R"(
localizer:
  robots: [{name: A, id: 1}]
  safety: {rovers_may_drive: true, sigma_hold_m: 0.2, sigma_stop_m: 0.5, margin_sigmas: 2}
  simulation:
    odometry: {rate_hz: 10, noise_scale: 2, speed_scale: 1.1, turn_scale: 0.9, turn_bias_radps: 0.01,
               slips_per_min: 3, slip_s: 0.7, slip_share: 0.4}
    sightings: {rate_hz: 4, noise_scale: 3, range_min_m: 0.3, range_max_m: 6, fov_deg: 180,
                detection_probability: 0.8}
    mocap_withheld: [{after_take_off: true, from_s: 5},
                     {from_s: 1, to_s: 2, area: {min_m: [0, 1], max_m: [2, 3]}}]
)",
                                    "x.yaml");
  ASSERT_TRUE(spec && spec->simulation);
  EXPECT_TRUE(spec->safety.rovers_may_drive);
  EXPECT_EQ(spec->safety.sigma_hold_m, 0.2);
  EXPECT_EQ(spec->safety.sigma_stop_m, 0.5);
  EXPECT_EQ(spec->safety.margin_sigmas, 2.0);
  const SimulatedOdometerSpec& odometry = spec->simulation->odometry;
  EXPECT_EQ(odometry.rate_hz, 10.0);
  EXPECT_EQ(odometry.noise_scale, 2.0);
  EXPECT_EQ(odometry.speed_scale, 1.1);
  EXPECT_EQ(odometry.turn_scale, 0.9);
  EXPECT_EQ(odometry.turn_bias_radps, 0.01);
  EXPECT_EQ(odometry.slips_per_min, 3.0);
  EXPECT_EQ(odometry.slip_s, 0.7);
  EXPECT_EQ(odometry.slip_share, 0.4);
  const SimulatedSightingsSpec& sightings = spec->simulation->sightings;
  EXPECT_EQ(sightings.rate_hz, 4.0);
  EXPECT_EQ(sightings.noise_scale, 3.0);
  EXPECT_EQ(sightings.range_min_m, 0.3);
  EXPECT_EQ(sightings.range_max_m, 6.0);
  EXPECT_NEAR(sightings.fov_rad, kPi, 1e-12);
  EXPECT_EQ(sightings.detection_probability, 0.8);
  ASSERT_EQ(spec->simulation->mocap_withheld.size(), 2U);
  const MocapOutageSpec& flying = spec->simulation->mocap_withheld[0];
  EXPECT_TRUE(flying.after_take_off);
  EXPECT_EQ(flying.from_s, 5.0);
  EXPECT_FALSE(flying.area);
  const MocapOutageSpec& corner = spec->simulation->mocap_withheld[1];
  EXPECT_EQ(corner.to_s, 2.0);
  EXPECT_EQ(corner.area->min_m, Eigen::Vector2d(0.0, 1.0));
  EXPECT_EQ(corner.area->max_m, Eigen::Vector2d(2.0, 3.0));
}

TEST(LocalizerScenario, KeepsMocapAndStopsRoversWithoutItByDefault) {
  const auto spec = parse_localizer(
      kTeam + "localizer: {robots: [{name: A, id: 1}], simulation: {odometry: {}}}\n", "x.yaml");
  ASSERT_TRUE(spec && spec->simulation);
  EXPECT_TRUE(spec->simulation->mocap_withheld.empty());
  EXPECT_FALSE(spec->safety.rovers_may_drive);
}

TEST(LocalizerScenario, RefusesMistakes) {
  struct Row {
    const char* localizer;
    const char* message;
  };
  for (const Row& row : {
           Row{"localizer: {landmarks: []}\n", "robots"},
           Row{"localizer: {robots: [{name: C, id: 1}]}\n", "must be the name of one of"},
           Row{"localizer: {robots: [{name: A, id: 1}, {name: A, id: 2}]}\n", "must be unique"},
           Row{"localizer: {robots: [{name: A, id: 1}, {name: B, id: 1}]}\n", "must be unique"},
           Row{"localizer: {landmarks: [{id: 1, x_m: 0, y_m: 0}], robots: [{name: A, id: 1}]}\n",
               "must be unique"},
           Row{"localizer: {landmarks: [{id: 1, x_m: 0}], robots: [{name: A, id: 2}]}\n", "y_m"},
           Row{"localizer: {robots: [{name: A, id: 1, drive: {delay_s: -1}}]}\n", "delay_s"},
           Row{"localizer: {robots: [{name: A, id: 1}], what: 1}\n", "what"},
           Row{"localizer: {robots: [{name: A, id: 1}], safety: {sigma_hold_m: 0.5}}\n",
               "must be above sigma_hold_m"},
           Row{"localizer: {robots: [{name: A, id: 1}], simulation: {mocap_withheld: [{from_s: 3, "
               "to_s: 2}]}}\n",
               "must be above from_s"},
           Row{"planner: {step_s: 0.25}\n"
               "localizer: {robots: [{name: A, id: 1}], simulation: {odometry: {}}}\n",
               "multiple of 0.1 s"},
       }) {
    EXPECT_NE(refusal_of(row.localizer).find(row.message), std::string::npos)
        << row.localizer << refusal_of(row.localizer);
  }
}

}  // namespace
}  // namespace vantage::scenario
