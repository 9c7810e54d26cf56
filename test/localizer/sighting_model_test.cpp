#include "localizer/sighting_model.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::localizer {
namespace {

constexpr scenario::SightingSpec kDepth{true, 1.03, 0.12, 0.03, -0.02, 0.09, 0.037};
constexpr scenario::SightingSpec kDistance{false, 0.98, -0.05, 0.0, 0.01, -0.04, 0.0};

Eigen::Vector2d observed(const scenario::SightingSpec& spec, const Pose2& pose,
                         const Eigen::Vector2d& point_m) {
  const ExpectedSighting expected = expected_sighting(spec, pose, point_m);
  return {expected.range_m, expected.bearing_rad};
}

TEST(SightingModel, MatchesClosedFormForPointAhead) {
  scenario::SightingSpec spec{true, 1.02, 0.1, 0.0, 0.0, 0.05, 0.0};
  const ExpectedSighting ahead = expected_sighting(spec, {0.0, 0.0, kPi / 2.0}, {0.0, 3.05});
  EXPECT_NEAR(ahead.range_m, 1.02 * 3.0 + 0.1, 1e-12);
  EXPECT_NEAR(ahead.bearing_rad, 0.0, 1e-12);
  EXPECT_NEAR(ahead.distance_m, 3.0, 1e-12);
}

TEST(SightingModel, ReportsDepthOfPointToTheSideIfRangeIsDepth) {
  scenario::SightingSpec spec;
  const Eigen::Vector2d point_m(3.0, 4.0);
  EXPECT_NEAR(expected_sighting(spec, {}, point_m).range_m, 5.0, 1e-12);
  spec.range_is_depth = true;
  EXPECT_NEAR(expected_sighting(spec, {}, point_m).range_m, 3.0, 1e-12);
}

TEST(SightingModel, DerivativesAgreeWithFiniteDifferences) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const scenario::SightingSpec& spec = i % 2 == 0 ? kDepth : kDistance;
    const Pose2 pose{uniform(rng), uniform(rng), 3.0 * uniform(rng)};
    const double bearing_rad = 1.2 * uniform(rng);
    const double distance_m = 2.0 + uniform(rng);
    const Eigen::Vector2d point_m = pose * Eigen::Vector2d(distance_m * std::cos(bearing_rad),
                                                           distance_m * std::sin(bearing_rad));
    const ExpectedSighting expected = expected_sighting(spec, pose, point_m);
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      Pose2 plus = pose;
      Pose2 minus = pose;
      (axis == 0 ? plus.x_m : axis == 1 ? plus.y_m : plus.yaw_rad) += kStep;
      (axis == 0 ? minus.x_m : axis == 1 ? minus.y_m : minus.yaw_rad) -= kStep;
      const Eigen::Vector2d slope =
          (observed(spec, plus, point_m) - observed(spec, minus, point_m)) / (2.0 * kStep);
      EXPECT_NEAR((slope - expected.by_pose.col(axis)).norm(), 0.0, 1e-7) << i << ' ' << axis;
    }
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step_m = kStep * Eigen::Vector2d::Unit(axis);
      const Eigen::Vector2d slope =
          (observed(spec, pose, point_m + step_m) - observed(spec, pose, point_m - step_m)) /
          (2.0 * kStep);
      EXPECT_NEAR((slope - expected.by_point.col(axis)).norm(), 0.0, 1e-7) << i << ' ' << axis;
    }
  }
}

TEST(SightingModel, SightedPointInvertsExpectedSighting) {
  for (const scenario::SightingSpec& spec : {kDepth, kDistance}) {
    for (const double bearing_rad : {-0.6, 0.0, 0.4}) {
      const Eigen::Vector2d body_m(4.0 * std::cos(bearing_rad), 4.0 * std::sin(bearing_rad));
      const Eigen::Vector2d z = observed(spec, {}, body_m);
      EXPECT_NEAR((sighted_point_m(spec, z.x(), z.y()) - body_m).norm(), 0.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace vantage::localizer
