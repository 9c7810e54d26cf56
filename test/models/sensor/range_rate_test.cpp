#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "models/sensor/law.hpp"
#include "models/sensor/sensor.hpp"
#include "test/models/sensor/random_target.hpp"
#include "test/support/near.hpp"
#include "test/support/numerical_jacobian.hpp"
#include "test/support/random.hpp"

// Tests sensors that measure the target's velocity, and parameters that only one kind has.

namespace vantage::models {
namespace {

using test::kKinds;
using test::of_kind;

StateVector random_state(test::Random& random) {
  StateVector state(4);
  state << random.vector<2>(-4.0, 4.0), random.vector<2>(-2.0, 2.0);
  return state;
}

TEST(RangeRate, IsTheDerivativeOfTheRangeOfAMovingTarget) {
  test::Random random(91);
  const SensorModel sensor = of_kind(SensorKind::kRangeRate);
  for (int i = 0; i < 200; ++i) {
    const Viewpoint from{random.pose2(4.0), random.uniform(0.0, 3.0)};
    const StateVector state = random_state(random);
    constexpr double kStep_s = 1e-5;
    const auto range_m = [&](double t_s) {
      const Eigen::Vector2d there_m = state.head<2>() + t_s * state.tail<2>();
      return (there_m - from.world_from_body.position_m()).norm();
    };
    const MeasurementVector z = observe_state(sensor, from, state);
    ASSERT_EQ(z.rows(), 2);
    EXPECT_NEAR(z(0), range_m(0.0), 1e-12);
    EXPECT_NEAR(z(1), (range_m(kStep_s) - range_m(-kStep_s)) / (2.0 * kStep_s), 1e-6);
  }
}

TEST(RangeRate, IsZeroForATargetThatCircles) {
  const SensorModel sensor = of_kind(SensorKind::kRangeRate);
  const MeasurementVector z = observe(sensor, {}, Eigen::Vector2d(3.0, 0.0), {0.0, 1.5});
  EXPECT_EQ(z(1), 0.0);
  EXPECT_EQ(observe(sensor, {}, Eigen::Vector2d(3.0, 0.0), {-1.5, 0.7})(1), -1.5);
}

TEST(StateJacobian, AgreesWithFiniteDifferences) {
  test::Random random(92);
  for (const SensorKind kind : kKinds) {
    int compared = 0;
    while (compared < 500) {
      SensorModel sensor = of_kind(kind);
      sensor.camera_tilt_rad = random.uniform(0.0, kPi / 2);
      sensor.depth_min_m = 0.5;
      sensor.calibration = {random.uniform(0.9, 1.1), random.uniform(-0.2, 0.2)};
      const Viewpoint from{random.pose2(4.0), random.uniform(1.5, 3.0)};
      const StateVector state = random_state(random);
      if (!in_view(sensor, from, PositionVector(state.head<2>()))) {
        continue;
      }
      ++compared;
      const MeasurementVector here = observe_state(sensor, from, state);
      const MeasurementJacobian H = state_jacobian(sensor, from, state);
      ASSERT_EQ(H.cols(), 4);
      for (int row = 0; row < H.rows(); ++row) {
        const auto h = [&](const Eigen::Vector4d& y) {
          return Eigen::Matrix<double, 1, 1>(
              innovation(sensor, observe_state(sensor, from, y), here)(row));
        };
        const Eigen::RowVector4d numeric =
            test::numerical_jacobian<1, 4>(h, Eigen::Vector4d(state));
        const double scale = 1.0 + H.row(row).cwiseAbs().maxCoeff();
        ASSERT_TRUE(test::is_near((H.row(row) / scale).eval(), (numeric / scale).eval(), 1e-6))
            << kind.name();
      }
    }
  }
}

TEST(StateInformation, PositionBlockEqualsInformationForKindsWithoutVelocity) {
  test::Random random(93);
  for (const SensorKind kind : kKinds) {
    const SensorModel sensor = of_kind(kind);
    for (int i = 0; i < 200; ++i) {
      const Viewpoint from{random.pose2(4.0), 2.0};
      const StateVector state = random_state(random);
      const StateMatrix M = state_information(sensor, from, state);
      const bool is_seen = in_view(sensor, from, PositionVector(state.head<2>()));
      ASSERT_EQ(M.isZero(0.0), !is_seen);
      if (measures_velocity(sensor)) {
        const MeasurementJacobian H = state_jacobian(sensor, from, state);
        const MeasurementMatrix V = noise_covariance(sensor, from, PositionVector(state.head<2>()));
        const Eigen::Matrix4d expected = H.transpose() * V.inverse() * H;
        ASSERT_TRUE(!is_seen || test::is_near(M, expected, 1e-9 * (1.0 + expected.norm())));
      } else {
        const PositionMatrix expected = information(sensor, from, PositionVector(state.head<2>()));
        ASSERT_EQ(PositionMatrix(M.topLeftCorner(2, 2)), expected) << kind.name();
        ASSERT_TRUE(M.bottomRows(2).isZero(0.0)) << kind.name();
      }
    }
  }
}

double largest_eigenvalue(const StateMatrix& M) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(Eigen::Matrix4d(M), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

TEST(StateInformationBound, IsNeverExceededFromAnyReachableViewpoint) {
  test::Random random(94);
  int seen = 0;
  double closest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    SensorModel sensor = of_kind(SensorKind::kRangeRate);
    sensor.range_max_m = random.uniform(0.5, 6.0);
    sensor.range_min_m = random.uniform(0.05, 0.5);
    sensor.own[0] = random.uniform(0.02, 0.5);
    sensor.variance_grows_with_range = random.coin();
    sensor.variance_floor = random.uniform(0.02, 0.5);
    const StateVector state = random_state(random);
    const PositionVector target = state.head<2>();
    const Viewpoint from{random.pose2(3.0), 2.0};
    const double reach_m = random.uniform(0.0, 3.0);
    const double speed_mps = state.tail<2>().norm() * (random.coin() ? 1.0 : 1.3);
    const double bound = information_bound(sensor, from, reach_m, target, speed_mps);
    for (int k = 0; k < 15; ++k) {
      const double way_m = reach_m * std::sqrt(random.uniform(0.0, 1.0));
      const double angle_rad = random.uniform(-kPi, kPi);
      Viewpoint there = from;
      there.world_from_body.x_m += way_m * std::cos(angle_rad);
      there.world_from_body.y_m += way_m * std::sin(angle_rad);
      const StateMatrix M = state_information(sensor, there, state);
      if (M.isZero(0.0)) {
        continue;
      }
      ++seen;
      const double attained = largest_eigenvalue(M);
      ASSERT_LE(attained, bound * (1.0 + 1e-12));
      closest = std::max(closest, attained / bound);
    }
  }
  EXPECT_GT(seen, 3000);
  EXPECT_GT(closest, 0.99);
}

TEST(StateInformationBound, IsAttainedByATargetThatCirclesAtTheNearestDistance) {
  SensorModel sensor = of_kind(SensorKind::kRangeRate);
  const Eigen::Vector2d target_m(3.0, 0.0);
  StateVector state(4);
  state << target_m, 0.0, 1.2;
  const double attained =
      largest_eigenvalue(state_information(sensor, {{1.0, 0.0, 0.0}, 0.0}, state));
  EXPECT_NEAR(information_bound(sensor, {}, 1.0, target_m, 1.2) / attained, 1.0, 1e-6);
  EXPECT_NEAR(attained, (1.0 + 0.36) / (0.1 * 0.1), 1e-9);
}

TEST(StateInformationBound, IsInfiniteWithoutMinimumRange) {
  SensorModel sensor = of_kind(SensorKind::kRangeRate);
  sensor.range_min_m = 0.0;
  const Eigen::Vector2d target_m(1.0, 0.0);
  EXPECT_EQ(information_bound(sensor, {}, 2.0, target_m, 0.5),
            std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(information_bound(sensor, {}, 2.0, target_m, 0.0)));
}

TEST(SensorParameters, HaveDefaultValuesUntilSet) {
  SensorModel sensor = of_kind(SensorKind::kRangeRate);
  ASSERT_EQ(find_parameter(sensor.kind, "range_rate_sigma_mps"), 0);
  EXPECT_FALSE(find_parameter(sensor.kind, "range_sigma_m"));
  EXPECT_FALSE(find_parameter(SensorKind::kRange, "range_rate_sigma_mps"));
  EXPECT_EQ(own_parameter(sensor, 0), 0.1);
  sensor.own[0] = 0.25;
  EXPECT_EQ(own_parameter(sensor, 0), 0.25);
  EXPECT_EQ(noise_covariance(sensor, {}, Eigen::Vector2d(2.0, 0.0))(1, 1), 0.0625);
  EXPECT_EQ(broken_parameter(sensor), nullptr);
  sensor.own[0] = 0.0;
  ASSERT_NE(broken_parameter(sensor), nullptr);
  EXPECT_EQ(broken_parameter(sensor)->name, "range_rate_sigma_mps");
}

TEST(SensorParameters, EveryKindDeclaresAllowedDefaultsAndDistinctNames) {
  for (const SensorKind kind : kKinds) {
    const auto all = kind.law().parameters;
    EXPECT_LE(all.size(), std::size_t{kMaxOwnParameters}) << kind.name();
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_TRUE(is_allowed(all[i].rule, all[i].initial)) << all[i].name;
      EXPECT_FALSE(all[i].purpose.empty() || all[i].unit.empty()) << all[i].name;
      EXPECT_EQ(find_parameter(kind, all[i].name), static_cast<int>(i));
    }
  }
}

TEST(SensorParameters, RulesAllowTheirValuesOnly) {
  EXPECT_TRUE(is_allowed(ParameterRule::kAny, -1.0));
  EXPECT_FALSE(is_allowed(ParameterRule::kAny, std::nan("")));
  EXPECT_TRUE(is_allowed(ParameterRule::kAtLeastZero, 0.0));
  EXPECT_FALSE(is_allowed(ParameterRule::kAtLeastZero, -1e-9));
  EXPECT_FALSE(is_allowed(ParameterRule::kAboveZero, 0.0));
  EXPECT_FALSE(is_allowed(ParameterRule::kAboveZero, std::numeric_limits<double>::infinity()));
}

}  // namespace
}  // namespace vantage::models
