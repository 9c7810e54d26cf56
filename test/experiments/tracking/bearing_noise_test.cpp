#include "experiments/tracking/bearing_noise.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "estimator/tracks/gaussian/track.hpp"
#include "planner/problem/fixed_information.hpp"
#include "planner/problem/sight.hpp"
#include "test/support/near.hpp"
#include "test/support/numerical_jacobian.hpp"
#include "test/support/random.hpp"

namespace vantage::experiments {
namespace {

models::SensorModel sensor_of(double fov_rad = radians(94.0)) {
  models::SensorModel sensor;
  sensor.kind = range_bearing_by_bearing();
  sensor.range_max_m = 10.0;
  sensor.fov_rad = fov_rad;
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = true;
  return sensor;
}

Eigen::Vector2d at(double range_m, double bearing_rad) {
  return range_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
}

// A target that is in view of a random pose.
struct Look {
  models::Viewpoint from;
  Eigen::Vector2d target_m;
};

Look random_look(test::Random& random) {
  const Pose2 pose = random.pose2(5.0);
  return {{pose, 0.0}, pose * at(random.uniform(0.5, 9.9), random.uniform(-0.8, 0.8))};
}

TEST(BearingNoise, GrowsWithTheBearingOnly) {
  const models::SensorModel sensor = sensor_of();
  const auto variances = [&](double range_m, double bearing_rad) {
    return Eigen::Vector2d(
        models::noise_covariance(sensor, {}, at(range_m, bearing_rad)).diagonal());
  };
  const double full_m2 = 0.15 * 0.15;
  const double full_rad2 = radians(5.0) * radians(5.0);
  for (const double range_m : {0.5, 5.0, 9.0}) {
    const double of_range_m2 = full_m2 * std::max(0.1, range_m / 10.0);
    for (const double side : {-1.0, 1.0}) {
      EXPECT_TRUE(test::is_near(variances(range_m, side * radians(23.5)),
                                Eigen::Vector2d(of_range_m2, 0.5 * full_rad2), 1e-12));
      EXPECT_TRUE(test::is_near(variances(range_m, side * radians(46.999999)),
                                Eigen::Vector2d(of_range_m2, full_rad2), 1e-9));
      EXPECT_TRUE(test::is_near(variances(range_m, side * radians(1.0)),
                                Eigen::Vector2d(of_range_m2, 0.1 * full_rad2), 1e-12))
          << "minimum noise";
    }
  }
}

TEST(BearingNoise, IsLargestBehindTheRobot) {
  const models::SensorModel sensor = sensor_of(2.0 * kPi);
  const double full_rad2 = radians(5.0) * radians(5.0);
  EXPECT_NEAR(models::noise_covariance(sensor, {}, Eigen::Vector2d(-3.0, 0.0))(1, 1), full_rad2,
              1e-12);
  EXPECT_NEAR(models::noise_covariance(sensor, {}, Eigen::Vector2d(0.0, 3.0))(1, 1),
              0.5 * full_rad2, 1e-12);
}

TEST(BearingNoise, JacobianEqualsNumericalDerivative) {
  const models::SensorModel sensor = sensor_of();
  test::Random random(5);
  for (int i = 0; i < 1'000; ++i) {
    const Look look = random_look(random);
    const auto h = [&](const Eigen::Vector2d& y_m) -> Eigen::Vector2d {
      const models::MeasurementVector here = models::observe(sensor, look.from, look.target_m);
      return models::innovation(sensor, models::observe(sensor, look.from, y_m), here);
    };
    ASSERT_TRUE(test::is_near(models::observation_jacobian(sensor, look.from, look.target_m),
                              test::numerical_jacobian<2, 2>(h, look.target_m), 1e-6));
  }
}

// The information gain that a plan predicts, for its own robot or for a teammate, equals the
// filter's gain from such a measurement.
TEST(BearingNoise, IsEqualInPlannerAndFilter) {
  planner::SearchProblem problem;
  problem.sensors = {sensor_of()};
  problem.controls = models::standard_primitives();
  problem.horizon_steps = 1;
  models::StateMatrix prior = models::StateMatrix::Zero(4, 4);
  prior.diagonal() << 1e-4, 2e-4, 1e-4, 1e-4;  // small, so that the measurement is almost linear
  planner::SightTable sight;
  test::Random random(6);
  for (int i = 0; i < 1'000; ++i) {
    const Look look = random_look(random);
    const Pose2& pose = look.from.world_from_body;
    models::Gaussian belief{models::StateVector::Zero(4), prior};
    belief.mean.head<2>() = look.target_m;
    const models::Measurement z =
        models::sample(problem.sensors[0], look.from, look.target_m, random.engine());
    ASSERT_EQ(z.V, models::noise_covariance(problem.sensors[0], look.from, look.target_m));
    const models::MeasurementJacobian H =
        models::observation_jacobian(problem.sensors[0], look.from, look.target_m);
    const Eigen::Matrix2d expected = H.transpose() * z.V.inverse() * H;
    const double slack = 1e-9 * expected.norm();

    sight.reset(problem);
    planner::PackedInformation planned{};
    ASSERT_TRUE(sight.add_information({look.target_m.x(), look.target_m.y(), 0.0},
                                      Eigen::Vector2d::Zero(), planner::BlockLayout::kMoving, pose,
                                      std::cos(pose.yaw_rad), std::sin(pose.yaw_rad), planned));
    EXPECT_NEAR(planned.m[0], expected(0, 0), slack);
    EXPECT_NEAR(planned.m[1], expected(0, 1), slack);
    EXPECT_NEAR(planned.m[2], expected(1, 1), slack);

    if (models::in_view(problem.sensors[0], look.from, look.target_m) &&
        std::abs(models::observe(problem.sensors[0], look.from, look.target_m)(1)) < 0.6) {
      auto information = models::to_information(belief);
      ASSERT_TRUE(information);
      const models::StateMatrix before = information->matrix;
      ASSERT_EQ(estimator::measure(*information, problem.sensors[0], look.from, z, 0.0),
                estimator::Use::kUsed);
      const Eigen::Matrix2d gained = (information->matrix - before).topLeftCorner<2, 2>();
      EXPECT_TRUE(test::is_near(gained, expected, 1e-6 * expected.norm()));
    }
  }
}

TEST(BearingNoise, RespectsItsInformationBound) {
  test::Random random(7);
  int seen = 0;
  for (int i = 0; i < 20'000; ++i) {
    models::SensorModel sensor = sensor_of(random.coin() ? 2.0 * kPi : radians(94.0));
    sensor.range_min_m = random.uniform(0.01, 2.0);
    sensor.variance_floor = random.uniform(0.02, 1.5);
    sensor.variance_grows_with_range = random.coin();
    const models::Viewpoint from{random.pose2(6.0), 0.0};
    const double reach_m = random.uniform(0.0, 4.0);
    const Eigen::Vector2d target_m = random.vector<2>(-6.0, 6.0);
    const double bound = models::information_bound(sensor, from, reach_m, target_m);
    models::Viewpoint reached = from;
    const double angle_rad = random.uniform(-kPi, kPi);
    const double way_m = reach_m * random.uniform(0.0, 1.0);
    reached.world_from_body.x_m += way_m * std::cos(angle_rad);
    reached.world_from_body.y_m += way_m * std::sin(angle_rad);
    reached.world_from_body.yaw_rad = random.uniform(-kPi, kPi);
    const models::PositionMatrix M = models::information(sensor, reached, target_m);
    const double most = Eigen::SelfAdjointEigenSolver<models::PositionMatrix>(M).eigenvalues()(1);
    ASSERT_LE(most, bound * (1.0 + 1e-9));
    seen += most > 0.0 ? 1 : 0;
  }
  EXPECT_GT(seen, 2'000);
}

}  // namespace
}  // namespace vantage::experiments
