#include "models/sensor/sensor.hpp"

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "test/models/sensor/random_target.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"
#include "test/support/numerical_jacobian.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

using test::kKinds;
using test::of_kind;
using test::random_target;

// Returns ∂h/∂y by central differences of innovation(), which handles the wrap of a bearing.
template <int Dim>
Eigen::MatrixXd numerical(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target, double h) {
  const MeasurementVector at_target = observe(sensor, from, target);
  Eigen::MatrixXd J(at_target.rows(), Dim);
  for (int row = 0; row < J.rows(); ++row) {
    const auto f = [&](const Eigen::Matrix<double, Dim, 1>& y) {
      return Eigen::Matrix<double, 1, 1>(
          innovation(sensor, observe(sensor, from, y), at_target)(row));
    };
    J.row(row) = test::numerical_jacobian<1, Dim>(f, Eigen::Matrix<double, Dim, 1>(target), h);
  }
  return J;
}

Eigen::MatrixXd numerical(const SensorModel& sensor, const Viewpoint& from,
                          const PositionVector& target, double h) {
  return target.rows() == 2 ? numerical<2>(sensor, from, target, h)
                            : numerical<3>(sensor, from, target, h);
}

TEST(ObservationJacobian, AgreesWithFiniteDifferences) {
  test::Random random(61);
  for (const SensorKind kind : kKinds) {
    for (const int dim : {2, 3}) {
      int compared = 0;
      while (compared < 2000) {
        SensorModel sensor = of_kind(kind);
        sensor.camera_tilt_rad = random.uniform(0.0, kPi / 2);
        sensor.calibration = {random.uniform(0.9, 1.1), random.uniform(-0.2, 0.2)};
        const Viewpoint from{random.pose2(4.0), random.uniform(1.5, 3.0)};
        const PositionVector target = random_target(random, dim, 4.0);
        sensor.depth_min_m = 0.5;
        if (!in_view(sensor, from, target)) {
          continue;
        }
        ++compared;
        const Eigen::MatrixXd H = observation_jacobian(sensor, from, target);
        const double scale = 1.0 + H.cwiseAbs().maxCoeff();
        ASSERT_TRUE(test::is_near((H / scale).eval(),
                                  (numerical(sensor, from, target, 1e-6) / scale).eval(), 1e-7));
      }
    }
  }
}

// Tests viewpoints almost above the target, a camera almost at its minimum depth, and bearings near
// ±π.
TEST(ObservationJacobian, AgreesWithFiniteDifferencesNearItsSingularPoints) {
  test::Random random(62);
  for (const SensorKind kind : kKinds) {
    for (const int dim : {2, 3}) {
      for (int i = 0; i < 500; ++i) {
        const SensorModel sensor = of_kind(kind);
        const double height_m = kind == SensorKind::kCamera ? 0.06 : random.uniform(0.0, 1e-3);
        const Viewpoint from{random.pose2(0.0), height_m};
        const double angle_rad =
            i % 2 == 0 ? random.uniform(-kPi, kPi) : kPi + from.world_from_body.yaw_rad;
        PositionVector target = PositionVector::Zero(dim);
        target.head(2) = 1e-3 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
        const Eigen::MatrixXd H = observation_jacobian(sensor, from, target);
        const double scale = 1.0 + H.cwiseAbs().maxCoeff();
        ASSERT_TRUE(test::is_near((H / scale).eval(),
                                  (numerical(sensor, from, target, 1e-8) / scale).eval(), 1e-6));
      }
    }
  }
}

TEST(Observe, IsInvariantToRigidMotions) {
  test::Random random(63);
  for (const SensorKind kind : kKinds) {
    for (int i = 0; i < 500; ++i) {
      const SensorModel sensor = of_kind(kind);
      const Viewpoint from{random.pose2(4.0), 2.0};
      const PositionVector target = random_target(random, 2, 4.0);
      const Pose2 moved_from_world = random.pose2(10.0);
      const Viewpoint moved{moved_from_world * from.world_from_body, 2.0};
      const Eigen::Vector2d target2 = target.head<2>();
      const PositionVector moved_target = moved_from_world * target2;
      const MeasurementVector difference =
          innovation(sensor, observe(sensor, moved, moved_target), observe(sensor, from, target));
      ASSERT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
      ASSERT_EQ(in_view(sensor, from, target), in_view(sensor, moved, moved_target));
    }
  }
}

TEST(Observe, ReturnsTargetInBodyFrame) {
  const Viewpoint from{{1.0, 2.0, kPi / 2}, 3.0};  // faces world y; −x is to its left
  const Eigen::Vector2d planar(0.0, 6.0);          // m; 4 m ahead, 1 m to the left
  const Eigen::Vector3d spatial(0.0, 6.0, 1.0);
  EXPECT_TRUE(test::is_near(observe(of_kind(SensorKind::kPosition), from, planar),
                            Eigen::Vector2d(4.0, 1.0), 1e-14));
  EXPECT_TRUE(test::is_near(observe(of_kind(SensorKind::kPosition), from, spatial),
                            Eigen::Vector3d(4.0, 1.0, -2.0), 1e-14));
  EXPECT_NEAR(observe(of_kind(SensorKind::kRange), from, planar)(0), std::sqrt(17.0), 1e-14);
  EXPECT_NEAR(observe(of_kind(SensorKind::kRange), from, spatial)(0), std::sqrt(21.0), 1e-14);
  EXPECT_NEAR(observe(of_kind(SensorKind::kBearing), from, spatial)(0), std::atan2(1.0, 4.0),
              1e-14);
  EXPECT_TRUE(test::is_near(observe(of_kind(SensorKind::kRangeBearing), from, planar),
                            Eigen::Vector2d(std::sqrt(17.0), std::atan2(1.0, 4.0)), 1e-14));
}

TEST(Observe, PutsImageXToTheRightAndImageYDown) {
  SensorModel camera = of_kind(SensorKind::kCamera);
  camera.focal_length_pixels = 100.0;
  const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
  const Eigen::Vector2d ahead_and_left(0.5, 1.0);
  // The camera faces straight down, depth 2 m: ahead is up in the image, left is left.
  EXPECT_TRUE(
      test::is_near(observe(camera, from, ahead_and_left), Eigen::Vector2d(-50.0, -25.0), 1e-12));
  camera.camera_tilt_rad = 0.0;  // rad; faces body x: depth 4 m, ground below the horizon
  const Eigen::Vector2d ahead(4.0, -1.0);
  EXPECT_TRUE(test::is_near(observe(camera, from, ahead), Eigen::Vector2d(25.0, 50.0), 1e-12));
  camera.camera_tilt_rad = kPi / 4;  // rad; the optical axis meets the ground 2 m ahead
  EXPECT_TRUE(test::is_near(observe(camera, from, Eigen::Vector2d(2.0, 0.0)),
                            Eigen::Vector2d(0.0, 0.0), 1e-12));
}

TEST(Calibration, ScalesAndShiftsOnlyTheReportedRange) {
  SensorModel sensor = of_kind(SensorKind::kRangeBearing);
  const Viewpoint from{{0.0, 0.0, 0.0}, 1.0};
  const Eigen::Vector2d target(3.0, 4.0);
  const MeasurementMatrix V = noise_covariance(sensor, from, target);
  sensor.calibration = {1.02, -0.3};
  EXPECT_TRUE(test::is_near(observe(sensor, from, target),
                            Eigen::Vector2d(1.02 * 5.0 - 0.3, std::atan2(4.0, 3.0)), 1e-14));
  EXPECT_TRUE(test::is_near(noise_covariance(sensor, from, target), V, 0.0));
}

TEST(InView, ExcludesItsLimits) {
  SensorModel sensor = of_kind(SensorKind::kRangeBearing);
  sensor.range_max_m = 5.0;
  sensor.range_min_m = 1.0;
  const Viewpoint from{};
  EXPECT_FALSE(in_view(sensor, from, Eigen::Vector2d(5.0, 0.0)));
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(std::nextafter(5.0, 0.0), 0.0)));
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(1.0, 0.0)));
  EXPECT_FALSE(in_view(sensor, from, Eigen::Vector2d(std::nextafter(1.0, 0.0), 0.0)));
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(-2.0, 0.0)));  // field of view 2π: sees behind
  sensor.fov_rad = kPi;
  EXPECT_FALSE(in_view(sensor, from, Eigen::Vector2d(0.0, 2.0)));  // at exactly φ/2
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(0.001, 2.0)));
  EXPECT_FALSE(in_view(sensor, from, Eigen::Vector2d(-0.001, -2.0)));
  sensor.fov_rad = radians(360.0);
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(-2.0, 0.0)));
}

TEST(InView, MeasuresRangeInSpaceForTargetsInSpace) {
  SensorModel sensor = of_kind(SensorKind::kRange);
  sensor.range_max_m = 5.0;
  const Viewpoint from{{0.0, 0.0, 0.0}, 4.0};
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector2d(3.5, 0.0)));
  EXPECT_FALSE(in_view(sensor, from, Eigen::Vector3d(3.5, 0.0, 0.0)));
  EXPECT_TRUE(in_view(sensor, from, Eigen::Vector3d(3.5, 0.0, 1.0)));
}

TEST(InView, NeedsMinimumDepthForCamera) {
  SensorModel camera = of_kind(SensorKind::kCamera);
  camera.range_min_m = 0.0;
  camera.depth_min_m = 0.5;
  EXPECT_TRUE(in_view(camera, {{}, 0.5}, Eigen::Vector2d(0.0, 0.0)));
  EXPECT_FALSE(in_view(camera, {{}, 0.49}, Eigen::Vector2d(0.0, 0.0)));
  camera.camera_tilt_rad = 0.0;
  EXPECT_TRUE(in_view(camera, {{}, 1.0}, Eigen::Vector2d(0.6, 0.0)));
  EXPECT_FALSE(in_view(camera, {{}, 1.0}, Eigen::Vector2d(0.4, 3.0)));
  EXPECT_FALSE(in_view(camera, {{}, 1.0}, Eigen::Vector2d(-2.0, 0.0)));  // behind the image plane
}

TEST(InView, IsFalseWhereTheJacobianIsUndefined) {
  for (const SensorKind kind :
       {SensorKind::kRange, SensorKind::kBearing, SensorKind::kRangeBearing}) {
    SensorModel sensor = of_kind(kind);
    sensor.range_min_m = 0.0;
    EXPECT_FALSE(in_view(sensor, {}, Eigen::Vector2d(0.0, 0.0)));
    EXPECT_TRUE(information(sensor, {}, Eigen::Vector2d(0.0, 0.0)).isZero(0.0));
  }
  // Directly above a spatial target there is a range but no bearing.
  const Viewpoint above{{}, 2.0};
  const Eigen::Vector3d ground(0.0, 0.0, 0.0);
  EXPECT_TRUE(in_view(of_kind(SensorKind::kRange), above, ground));
  EXPECT_FALSE(in_view(of_kind(SensorKind::kBearing), above, ground));
}

TEST(NoiseCovariance, GrowsLinearlyWithRangeAboveItsFloor) {
  SensorModel sensor = of_kind(SensorKind::kRangeBearing);
  sensor.variance_grows_with_range = true;
  sensor.range_max_m = 10.0;
  const Eigen::Vector2d full(0.15 * 0.15, radians(5.0) * radians(5.0));
  const auto variances_at = [&](double range_m) {
    return Eigen::Vector2d(noise_covariance(sensor, {}, Eigen::Vector2d(0.0, range_m)).diagonal());
  };
  EXPECT_TRUE(test::is_near(variances_at(10.0), full, 1e-15));
  EXPECT_TRUE(test::is_near(variances_at(5.0), 0.5 * full, 1e-15));
  EXPECT_TRUE(test::is_near(variances_at(0.2), 0.1 * full, 1e-15));
  sensor.variance_grows_with_range = false;
  EXPECT_TRUE(test::is_near(variances_at(0.2), full, 1e-15));
}

TEST(Information, EqualsHtransposeVinverseHInViewAndZeroElsewhere) {
  test::Random random(64);
  for (const SensorKind kind : kKinds) {
    for (const int dim : {2, 3}) {
      int seen = 0;
      for (int i = 0; i < 2000; ++i) {
        SensorModel sensor = of_kind(kind);
        sensor.range_max_m = 4.0;
        sensor.fov_rad = radians(140.0);
        const Viewpoint from{random.pose2(3.0), 2.0};
        const PositionVector target = random_target(random, dim, 3.0);
        const PositionMatrix M = information(sensor, from, target);
        if (!in_view(sensor, from, target)) {
          ASSERT_TRUE(M.isZero(0.0));
          continue;
        }
        ++seen;
        const Eigen::MatrixXd H = observation_jacobian(sensor, from, target);
        const Eigen::MatrixXd V = noise_covariance(sensor, from, target);
        const Eigen::MatrixXd expected = H.transpose() * V.inverse() * H;
        ASSERT_TRUE(test::is_near(M, expected, 1e-12 * (1.0 + expected.norm())));
      }
      EXPECT_GT(seen, 100);
    }
  }
}

TEST(Innovation, WrapsTheBearing) {
  const SensorModel bearing = of_kind(SensorKind::kBearing);
  const Eigen::Matrix<double, 1, 1> almost_pi(kPi - 0.1);
  const Eigen::Matrix<double, 1, 1> beyond_pi(-kPi + 0.2);
  EXPECT_NEAR(innovation(bearing, almost_pi, beyond_pi)(0), -0.3, 1e-12);
  EXPECT_NEAR(innovation(bearing, beyond_pi, almost_pi)(0), 0.3, 1e-12);
  const SensorModel range = of_kind(SensorKind::kRange);  // a range must not be wrapped
  EXPECT_EQ(
      innovation(range, Eigen::Matrix<double, 1, 1>(7.0), Eigen::Matrix<double, 1, 1>(0.5))(0),
      6.5);
  const SensorModel both = of_kind(SensorKind::kRangeBearing);
  EXPECT_TRUE(test::is_near(innovation(both, Eigen::Vector2d(9.0, 3.0), Eigen::Vector2d(1.0, -3.0)),
                            Eigen::Vector2d(8.0, 6.0 - 2.0 * kPi), 1e-12));
}

// With n samples, a mean is within 5 σ/√n, and a variance within 5 √(2/n) of its value.
TEST(Sample, HasTheModelsMeanAndVariance) {
  constexpr int kSamples = 20'000;
  test::Random random(65);
  for (const SensorKind kind : kKinds) {
    SensorModel sensor = of_kind(kind);
    sensor.variance_grows_with_range = true;
    const Viewpoint from{{0.0, 0.0, 0.3}, 2.0};
    const Eigen::Vector3d target(-3.0 * std::cos(0.3), -3.0 * std::sin(0.3), 0.0);  // near ±π
    const MeasurementVector expected = observe(sensor, from, target);
    const MeasurementMatrix V = noise_covariance(sensor, from, target);
    const Eigen::Index rows = expected.rows();
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(rows);
    Eigen::MatrixXd sum2 = Eigen::MatrixXd::Zero(rows, rows);
    for (int i = 0; i < kSamples; ++i) {
      const Measurement measurement = sample(sensor, from, target, random.engine());
      ASSERT_EQ(measurement.V, V);
      const MeasurementVector error = innovation(sensor, measurement.z, expected);
      ASSERT_EQ(wrap_to_pi(measurement.z(rows - 1)) == measurement.z(rows - 1) ||
                    kind != SensorKind::kBearing,
                true);
      sum += error;
      sum2 += error * error.transpose();
    }
    for (int row = 0; row < rows; ++row) {
      EXPECT_NEAR(sum(row) / kSamples, 0.0, 5.0 * std::sqrt(V(row, row) / kSamples));
      for (int column = 0; column < rows; ++column) {
        const double scale = std::sqrt(V(row, row) * V(column, column));
        EXPECT_NEAR(sum2(row, column) / kSamples, V(row, column),
                    5.0 * std::sqrt(2.0 / kSamples) * scale);
      }
    }
  }
}

TEST(PositionFrom, InvertsObserve) {
  test::Random random(66);
  for (const SensorKind kind :
       {SensorKind::kPosition, SensorKind::kRangeBearing, SensorKind::kCamera}) {
    for (const int dim : {2, 3}) {
      int visible_count = 0;
      while (visible_count < 1000) {
        SensorModel sensor = of_kind(kind);
        sensor.camera_tilt_rad = random.uniform(0.3, kPi / 2);
        sensor.calibration = {random.uniform(0.9, 1.1), random.uniform(-0.2, 0.2)};
        const Viewpoint from{random.pose2(4.0), random.uniform(0.5, 3.0)};
        PositionVector target = random_target(random, dim, 4.0);
        if (dim == 3 && kind != SensorKind::kPosition) {
          target(2) = 0.0;  // m; position_from() assumes a target on the ground
        }
        if (!in_view(sensor, from, target)) {
          continue;
        }
        ++visible_count;
        const auto found = position_from(sensor, from, observe(sensor, from, target), dim);
        ASSERT_TRUE(found);
        ASSERT_TRUE(test::is_near(*found, target, 1e-7));
      }
    }
  }
}

TEST(PositionFrom, IsEmptyForAmbiguousSensors) {
  const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
  const Eigen::Matrix<double, 1, 1> one(1.0);
  EXPECT_FALSE(position_from(of_kind(SensorKind::kRange), from, one, 2));
  EXPECT_FALSE(position_from(of_kind(SensorKind::kBearing), from, one, 2));
  const SensorModel both = of_kind(SensorKind::kRangeBearing);
  EXPECT_FALSE(position_from(both, from, Eigen::Vector2d(-0.1, 0.0), 2));
  EXPECT_FALSE(position_from(both, from, Eigen::Vector2d(1.9, 0.0), 3));  // range < height
  EXPECT_FALSE(position_from(both, from, Eigen::Vector2d(std::nan(""), 0.0), 2));
  SensorModel camera = of_kind(SensorKind::kCamera);
  camera.camera_tilt_rad = 0.0;
  EXPECT_FALSE(position_from(camera, from, Eigen::Vector2d(0.0, -10.0), 2));  // above the horizon
  EXPECT_FALSE(position_from(camera, from, Eigen::Vector2d(0.0, 0.0), 2));    // on the horizon
}

TEST(Sensor, AllocatesNothing) {
  if (!test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "allocations are not counted under a sanitizer";
  }
  test::Random random(67);
  for (const SensorKind kind : kKinds) {
    for (const int dim : {2, 3}) {
      const SensorModel sensor = of_kind(kind);
      const Viewpoint from{{0.3, 0.2, 0.1}, 2.0};
      PositionVector target = PositionVector::Constant(dim, 1.0);
      const test::AllocationCounter allocations;
      ASSERT_TRUE(in_view(sensor, from, target));
      const Measurement measurement = sample(sensor, from, target, random.engine());
      const auto where = position_from(sensor, from, measurement.z, dim);
      const PositionMatrix M = information(sensor, from, target);
      const double bound = information_bound(sensor, from, 1.0, target);
      EXPECT_EQ(allocations.count(), 0u);
      EXPECT_GT(bound + M.sum() + (where ? 1.0 : 0.0), 0.0);
    }
  }
}

}  // namespace
}  // namespace vantage::models
