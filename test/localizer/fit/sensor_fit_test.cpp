#include "localizer/fit/sensor_fit.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "localizer/commanded_motion.hpp"
#include "localizer/fit/sighted_response.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

constexpr double kStepS = 0.02;

std::vector<scenario::LandmarkSpec> hall() {
  std::vector<scenario::LandmarkSpec> landmarks;
  for (int k = 0; k < 10; ++k) {
    const double angle_rad = 2.0 * kPi * k / 10.0;
    landmarks.push_back({k, {4.0 * std::cos(angle_rad), 3.0 * std::sin(angle_rad)}});
  }
  return landmarks;
}

/// Records a robot with the given sensor and drive for 120 s among the landmarks of hall().
RobotRecording recorded(const scenario::SightingSpec& sensor, const scenario::DriveSpec& drive) {
  RobotRecording recording;
  std::mt19937 rng(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  CommandedMotion motion(drive);
  Time now = from_utime(1'000'000'000'000);
  static_cast<void>(motion.advance_to(now));
  Pose2 pose;
  double turn_radps = 0.0;
  double speed_mps = 0.1;
  for (int i = 0; i < static_cast<int>(120.0 / kStepS); ++i) {
    if (i % 60 == 0) {
      turn_radps = 0.8 * uniform(rng);
      speed_mps = 0.1 + 0.08 * uniform(rng);
    }
    models::OdometryReport command;
    command.kind = models::OdometryKind::kCommand;
    command.stamp.time = now;
    command.motion_body = {speed_mps, 0.0, turn_radps};
    recording.odometry.push_back(command);
    recording.truth.add(now, pose);
    motion.command(now, speed_mps, turn_radps);
    now += from_seconds(kStepS);
    const Eigen::Vector3d moved = motion.advance_to(now);
    pose = pose * Pose2{moved.x(), moved.y(), moved.z()};
    if (i % 10 != 0) {
      continue;
    }
    SightingFrame frame{now + from_seconds(sensor.stamp_delay_s), {}};
    for (const scenario::LandmarkSpec& landmark : hall()) {
      const ExpectedSighting expected = expected_sighting(sensor, pose, landmark.position_m);
      if (std::abs(expected.bearing_rad) > 0.6 || expected.distance_m < 0.5) {
        continue;
      }
      const double d = expected.distance_m;
      frame.sightings.push_back({frame.stamp, landmark.id,
                                 expected.range_m + (0.01 + 0.002 * d * d) * normal(rng),
                                 expected.bearing_rad + 0.006 * normal(rng)});
    }
    recording.frames.push_back(frame);
  }
  return recording;
}

constexpr scenario::DriveSpec kDrive{0.15, 0.1, 1.03, 0.96, -0.002};

TEST(SensorFit, FindsDepthModelAndGeometry) {
  const scenario::SightingSpec sensor{true, 1.03, 0.12, 0.03, -0.01, 0.08, 0.04};
  const SensorFit fit = fit_sensor(hall(), recorded(sensor, kDrive));
  EXPECT_TRUE(fit.sensor.range_is_depth);
  EXPECT_LT(fit.depth_loss, fit.distance_loss);
  EXPECT_NEAR(fit.sensor.range_scale, 1.03, 0.003);
  EXPECT_NEAR(fit.sensor.range_offset_m, 0.12, 0.01);
  EXPECT_NEAR(fit.sensor.axis_rad, 0.03, 0.006);
  EXPECT_NEAR(fit.sensor.bearing_offset_rad, -0.01, 0.002);
  EXPECT_NEAR(fit.sensor.forward_m, 0.08, 0.01);
  EXPECT_NEAR(fit.sensor.stamp_delay_s, 0.04, 0.004);
  EXPECT_NEAR(fit.range_sigma_per_m, 0.002, 0.0005);
  EXPECT_NEAR(fit.bearing_sigma_rad, 0.006, 0.001);
  EXPECT_NEAR(fit.detection_probability, 1.0, 0.01);
  EXPECT_LT(fit.outliers, 0.01);
}

TEST(SensorFit, FindsDistanceModel) {
  const scenario::SightingSpec sensor{false, 0.98, 0.05, 0.0, 0.0, 0.0, 0.02};
  const SensorFit fit = fit_sensor(hall(), recorded(sensor, kDrive));
  EXPECT_FALSE(fit.sensor.range_is_depth);
  EXPECT_LT(fit.distance_loss, fit.depth_loss);
  EXPECT_NEAR(fit.sensor.range_scale, 0.98, 0.003);
}

TEST(SensorFit, CountsOutliersAndMissedDetections) {
  RobotRecording recording = recorded({true, 1.0, 0.0, 0.0, 0.0, 0.0, 0.03}, kDrive);
  int index = 0;
  for (SightingFrame& frame : recording.frames) {
    std::erase_if(frame.sightings, [&](const models::Sighting&) { return index++ % 4 == 0; });
    if (index % 10 == 0 && !frame.sightings.empty()) {
      frame.sightings.front().range_m += 2.0;
    }
  }
  const SensorFit fit = fit_sensor(hall(), recording);
  EXPECT_NEAR(fit.detection_probability, 0.75, 0.03);
  EXPECT_GT(fit.outliers, 0.01);
  EXPECT_LT(fit.outliers, 0.15);
  EXPECT_NEAR(fit.sensor.range_scale, 1.0, 0.005);
}

TEST(DriveFit, FindsDelayLagScalesAndBias) {
  const DriveFit fit = fit_drive(recorded({}, kDrive));
  EXPECT_NEAR(fit.drive.delay_s, kDrive.delay_s, 0.02);
  EXPECT_NEAR(fit.drive.lag_s, kDrive.lag_s, 0.02);
  EXPECT_NEAR(fit.drive.speed_scale, kDrive.speed_scale, 0.005);
  EXPECT_NEAR(fit.drive.turn_scale, kDrive.turn_scale, 0.005);
  EXPECT_NEAR(fit.drive.turn_bias_radps, kDrive.turn_bias_radps, 0.0005);
}

TEST(DriveFit, KeepsGivenResponse) {
  const DriveFit fit = fit_drive(recorded({}, kDrive), Response{0.2, 0.05});
  EXPECT_EQ(fit.drive.delay_s, 0.2);
  EXPECT_EQ(fit.drive.lag_s, 0.05);
}

TEST(SensorFit, KeepsGivenStampDelay) {
  const scenario::SightingSpec sensor{true, 1.03, 0.12, 0.03, -0.01, 0.08, 0.04};
  const SensorFit fit = fit_sensor(hall(), recorded(sensor, kDrive), 0.02);
  EXPECT_EQ(fit.sensor.stamp_delay_s, 0.02);
  EXPECT_NEAR(fit.sensor.range_scale, 1.03, 0.003);
}

TEST(SightedResponse, FindsSumOfDelayAndLagFromSightingsAlone) {
  const scenario::SightingSpec sensor{true, 1.03, 0.12, 0.03, -0.01, 0.08, 0.04};
  RobotRecording recording = recorded(sensor, kDrive);
  recording.truth = {};
  const Response response = sighted_response(hall(), sensor, recording);
  EXPECT_NEAR(response.delay_s + response.lag_s, kDrive.delay_s + kDrive.lag_s, 0.05);
  // An unknown delay of the stamps becomes part of the fitted delay of the commands.
  scenario::SightingSpec late = sensor;
  late.stamp_delay_s = 0.0;
  const Response later = sighted_response(hall(), late, recording);
  EXPECT_NEAR(later.delay_s + later.lag_s, response.delay_s + response.lag_s + 0.04, 0.02);
}

TEST(DriveFit, RefusesTooShortRecording) {
  RobotRecording recording = recorded({}, kDrive);
  recording.odometry.resize(100);
  EXPECT_THROW(static_cast<void>(fit_drive(recording)), UsageError);
  EXPECT_THROW(static_cast<void>(fit_drive({})), UsageError);
}

}  // namespace
}  // namespace vantage::localizer
