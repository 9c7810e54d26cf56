#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "models/sensor/sensor.hpp"
#include "test/support/random.hpp"

namespace vantage::models {
namespace {

const auto kKinds = all_sensor_kinds();

double largest_eigenvalue(const PositionMatrix& M) {
  return Eigen::SelfAdjointEigenSolver<PositionMatrix>(M, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

SensorModel random_sensor(test::Random& random, SensorKind kind) {
  SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = random.uniform(0.5, 6.0);
  sensor.range_min_m = random.coin() ? random.uniform(0.01, 0.5) : 0.0;
  sensor.fov_rad = random.coin() ? 2.0 * kPi : random.uniform(0.5, 6.0);
  sensor.camera_tilt_rad = random.coin() ? kPi / 2 : random.uniform(0.0, kPi / 2);
  sensor.depth_min_m = random.uniform(0.05, 0.5);
  sensor.variance_grows_with_range = random.coin();
  sensor.variance_floor = random.uniform(0.02, 0.5);
  sensor.calibration = {random.uniform(0.8, 1.2), random.uniform(-0.5, 0.5)};
  return sensor;
}

struct Question {
  Viewpoint from;
  double reach_m;
  PositionVector target;
};

Question random_question(test::Random& random) {
  PositionVector target = PositionVector::Zero(random.integer(2, 3));
  target.head(2) = random.vector<2>(-3.0, 3.0);
  if (target.rows() == 3) {
    target(2) = random.uniform(-0.5, 2.5);
  }
  return {{random.pose2(3.0), random.uniform(0.0, 3.0)}, random.uniform(0.0, 3.0), target};
}

// Returns a reachable viewpoint. On average, half of the results are at the full reach or as near
// to the target as possible, where information is largest.
Viewpoint reached(test::Random& random, const Question& question) {
  const Pose2& from = question.from.world_from_body;
  const Eigen::Vector2d to_target = question.target.head<2>() - from.position_m();
  double angle_rad = random.uniform(-kPi, kPi);
  double distance_m = question.reach_m * std::sqrt(random.uniform(0.0, 1.0));
  switch (random.integer(0, 3)) {
    case 0:
      distance_m = question.reach_m;
      break;
    case 1:
      angle_rad = std::atan2(to_target.y(), to_target.x());
      distance_m = std::min(question.reach_m, to_target.norm());
      break;
    default:
      break;
  }
  return {{from.x_m + distance_m * std::cos(angle_rad), from.y_m + distance_m * std::sin(angle_rad),
           random.uniform(-kPi, kPi)},
          question.from.height_m};
}

TEST(InformationBound, IsNeverExceededFromAnyReachableViewpoint) {
  test::Random random(71);
  for (const SensorKind kind : kKinds) {
    int seen = 0;
    for (int i = 0; i < 4000; ++i) {
      const SensorModel sensor = random_sensor(random, kind);
      const Question question = random_question(random);
      const double bound =
          information_bound(sensor, question.from, question.reach_m, question.target);
      for (int k = 0; k < 15; ++k) {
        const Viewpoint viewpoint = reached(random, question);
        const PositionMatrix M = information(sensor, viewpoint, question.target);
        if (M.isZero(0.0)) {
          continue;
        }
        ++seen;
        ASSERT_LE(largest_eigenvalue(M), bound * (1.0 + 1e-12))
            << "sensor kind " << kind.name() << ", reach " << question.reach_m;
      }
    }
    EXPECT_GT(seen, 3000) << "sensor kind " << kind.name();
  }
}

// A consistent heuristic requires this property: each viewpoint that is reachable after a step was
// also reachable before the step.
TEST(InformationBound, IsMonotonicInTheReach) {
  test::Random random(72);
  for (const SensorKind kind : kKinds) {
    for (int i = 0; i < 4000; ++i) {
      const SensorModel sensor = random_sensor(random, kind);
      const Question question = random_question(random);
      const Viewpoint next = reached(random, question);
      const double more_m = random.uniform(0.0, 2.0);
      const double now =
          information_bound(sensor, question.from, question.reach_m + more_m, question.target);
      ASSERT_LE(information_bound(sensor, next, more_m, question.target), now * (1.0 + 1e-6));
    }
  }
}

TEST(InformationBound, IsZeroForAnInvisibleTarget) {
  for (const SensorKind kind : kKinds) {
    SensorModel sensor;
    sensor.kind = kind;
    sensor.range_min_m = 0.1;
    sensor.range_max_m = 5.0;
    const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
    EXPECT_EQ(information_bound(sensor, from, 3.0, Eigen::Vector2d(8.1, 0.0)), 0.0);
    EXPECT_GT(information_bound(sensor, from, 3.0, Eigen::Vector2d(7.9, 0.0)), 0.0);
    EXPECT_EQ(information_bound(sensor, from, 0.0, Eigen::Vector3d(0.0, 0.0, 2.0)), 0.0);
    EXPECT_EQ(information_bound(sensor, from, 0.05, Eigen::Vector3d(0.0, 0.0, 1.95)), 0.0);
    EXPECT_EQ(information_bound(sensor, from, 100.0, Eigen::Vector3d(0.0, 0.0, 7.1)), 0.0);
  }
}

// The bearing of a target directly below is undefined. The bound is 0 until the reach allows enough
// lateral distance.
TEST(InformationBound, IsZeroDirectlyAboveTarget) {
  for (const SensorKind kind : {SensorKind::kRangeBearing, SensorKind::kBearing}) {
    SensorModel sensor;
    sensor.kind = kind;
    sensor.range_min_m = 0.1;
    const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
    const Eigen::Vector3d below_m(0.0, 0.0, 0.5);
    EXPECT_EQ(information_bound(sensor, from, 0.09, below_m), 0.0) << kind.name();
    EXPECT_GT(information_bound(sensor, from, 0.11, below_m), 0.0) << kind.name();
  }
}

TEST(InformationBound, IsAttainedAtTheBestViewpoint) {
  SensorModel sensor;
  sensor.range_min_m = 0.1;
  const Viewpoint from{{0.0, 0.0, 0.0}, 2.0};
  const Eigen::Vector2d target(3.0, 0.0);
  for (const SensorKind kind : kKinds) {
    sensor.kind = kind;
    const Viewpoint best{{1.0, 0.0, 0.0}, 2.0};
    const double attained = largest_eigenvalue(information(sensor, best, target));
    EXPECT_NEAR(information_bound(sensor, from, 1.0, target) / attained, 1.0, 1e-6)
        << "sensor kind " << kind.name();
  }
}

TEST(InformationBound, IsLimitedByMinimumRangeForBearing) {
  SensorModel sensor;
  sensor.kind = SensorKind::kBearing;
  sensor.range_min_m = 0.2;
  const double expected = 1.0 / std::pow(radians(5.0) * 0.2, 2.0);
  EXPECT_NEAR(information_bound(sensor, {}, 5.0, Eigen::Vector2d(1.0, 1.0)), expected,
              1e-9 * expected);
  sensor.range_min_m = 0.0;
  EXPECT_EQ(information_bound(sensor, {}, 5.0, Eigen::Vector2d(1.0, 1.0)), INFINITY);
}

// Beyond the range no viewpoint sees the target, so a larger reach adds nothing.
TEST(InformationBound, IsConstantBeyondTheSensorsRange) {
  for (const SensorKind kind : kKinds) {
    for (const double tilt_rad : {0.3, 1.0, kPi / 2}) {
      for (const double fov_rad : {1.0, 2.0 * kPi}) {
        SensorModel sensor;
        sensor.kind = kind;
        sensor.range_min_m = 0.1;
        sensor.range_max_m = 6.0;
        sensor.camera_tilt_rad = tilt_rad;
        sensor.fov_rad = fov_rad;
        const Viewpoint from{{1.0, -2.0, 0.5}, 2.0};
        for (const PositionVector& target : {PositionVector(Eigen::Vector2d(3.0, 0.0)),
                                             PositionVector(Eigen::Vector3d(3.0, 0.0, 0.4))}) {
          const double bound = information_bound(sensor, from, 10.0, target);
          EXPECT_GT(bound, 0.0);
          EXPECT_EQ(information_bound(sensor, from, 1'000.0, target), bound)
              << kind.name() << ' ' << tilt_rad << ' ' << target.rows();
        }
      }
    }
  }
}

// On its optical axis a stationary camera has the information (f / (σ d))² at depth d, which equals
// the bound. This applies at any tilt, for targets on the ground and above it.
TEST(InformationBound, IsReachedOnCameraAxis) {
  SensorModel sensor;
  sensor.kind = SensorKind::kCamera;
  sensor.focal_length_pixels = 400.0;
  sensor.pixel_sigma = 2.0;
  for (const double tilt_rad : {0.4, 0.9, kPi / 2}) {
    sensor.camera_tilt_rad = tilt_rad;
    // Straight down the bearing is undefined, so the sensor has a full field of view.
    sensor.fov_rad = tilt_rad < 1.0 ? 1e-3 : 2.0 * kPi;
    for (const double height_m : {1.0, 2.5}) {
      const double depth_m = height_m / std::sin(tilt_rad);
      const double ahead_m = height_m / std::tan(tilt_rad);
      const double expected = std::pow(400.0 / (2.0 * depth_m), 2.0);
      for (const double above_m : {0.0, 1.5}) {  // m; height of the target
        const Viewpoint from{{0.5, -1.0, 1.2}, height_m + above_m};
        const Eigen::Vector2d there_m(0.5 + ahead_m * std::cos(1.2),
                                      -1.0 + ahead_m * std::sin(1.2));
        const Eigen::Vector3d target_m(there_m.x(), there_m.y(), above_m);
        EXPECT_NEAR(information_bound(sensor, from, 0.0, target_m) / expected, 1.0, 1e-5);
        EXPECT_NEAR(largest_eigenvalue(information(sensor, from, target_m)) / expected, 1.0, 1e-5);
        if (above_m == 0.0) {
          EXPECT_NEAR(information_bound(sensor, from, 0.0, there_m) / expected, 1.0, 1e-5);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vantage::models
