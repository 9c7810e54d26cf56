#include "drivers/sensor/pose_noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "models/sensor/kind.hpp"

namespace vantage::drivers {
namespace {

const Pose2 kPose{1.0, -0.5, 0.7};
const models::PositionVector kTarget = Eigen::Vector2d(1.6, 0.1);

Eigen::Matrix3d pose_covariance() {
  Eigen::Matrix3d root;
  root << 0.1, 0.0, 0.0, 0.03, 0.08, 0.0, 0.02, -0.01, 0.05;
  return root * root.transpose();
}

models::SensorModel sensor_of(models::SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = 3.0;
  sensor.range_min_m = 0.1;
  return sensor;
}

class PoseNoise : public ::testing::TestWithParam<models::SensorKind> {};

// The added noise is H P Hᵀ, with the pose covariance P and H = ∂h/∂pose by central differences.
TEST_P(PoseNoise, EqualsTheDifferencesOfTheMeasurement) {
  const models::SensorModel sensor = sensor_of(GetParam());
  const models::Viewpoint from{kPose, 1.0};
  constexpr double kStep = 1e-6;
  const auto rows = models::observe(sensor, from, kTarget).size();
  Eigen::MatrixXd H(rows, 3);
  for (int i = 0; i < 3; ++i) {
    const auto at = [&](double step) {
      models::Viewpoint moved = from;
      Pose2& pose = moved.world_from_body;
      (i == 0 ? pose.x_m : i == 1 ? pose.y_m : pose.yaw_rad) += step;
      return models::observe(sensor, moved, kTarget);
    };
    H.col(i) = models::innovation(sensor, at(kStep), at(-kStep)) / (2.0 * kStep);
  }
  const Eigen::MatrixXd expected = H * pose_covariance() * H.transpose();
  const Eigen::MatrixXd added = pose_noise(sensor, from, kTarget, pose_covariance());
  EXPECT_LT((added - expected).norm(), 1e-6 * (1.0 + expected.norm()));
}

INSTANTIATE_TEST_SUITE_P(Kinds, PoseNoise,
                         ::testing::Values(models::SensorKind::kPosition,
                                           models::SensorKind::kRange, models::SensorKind::kBearing,
                                           models::SensorKind::kRangeBearing));

TEST(AssumePose, MovesTheViewpointAndAddsTheCovarianceOfThePose) {
  const models::SensorModel sensor = sensor_of(models::SensorKind::kRangeBearing);
  models::RobotMeasurement seen;
  seen.viewpoint = {{0.9, -0.4, 0.6}, 1.5};
  models::Measurement z;
  z.z = models::observe(sensor, {kPose, 1.5}, kTarget);
  z.V = models::noise_covariance(sensor, {kPose, 1.5}, kTarget);
  seen.detections = {{3, z}};
  models::PoseEstimate estimate;
  estimate.world_from_body = kPose;
  estimate.covariance = pose_covariance();
  assume_pose(sensor, 2, estimate, seen);
  EXPECT_EQ(seen.viewpoint.world_from_body, kPose);
  EXPECT_EQ(seen.viewpoint.height_m, 1.5);
  const Eigen::MatrixXd expected =
      z.V + pose_noise(sensor, {kPose, 1.5}, kTarget, pose_covariance());
  EXPECT_LT((seen.detections[0].measurement.V - expected).norm(), 1e-9);
  EXPECT_EQ(seen.detections[0].measurement.z, z.z);
}

}  // namespace
}  // namespace vantage::drivers
