#include "planner/search/sighting_value.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::planner {
namespace {

// A robot with 1 m/s, 2 rad/s, a range of 3 m and a field of view of 90°, and one target at the
// origin.
class Sighting : public ::testing::Test {
 protected:
  Sighting() {
    problem_.horizon_steps = 12;
    problem_.step_s = 0.5;
    problem_.controls = {{1.0, 0.0}, {1.0, 2.0}, {0.5, -1.0}};
    sensor_.kind = models::SensorKind::kRangeBearing;
    sensor_.range_max_m = 3.0;
    sensor_.fov_rad = 0.5 * kPi;
    problem_.sensors = {sensor_};
    problem_.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                         {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
    reset();
  }
  void reset() {
    expander_.reset(problem_);
    value_.reset(problem_, expander_);
  }
  /// Returns the value from `away_m` east of the target, with the target `aside_rad` left of
  /// straight ahead.
  [[nodiscard]] double at(double away_m, double aside_rad, int t) const {
    return value_.value({away_m, 0.0, wrap_to_pi(kPi - aside_rad)}, t);
  }

  SearchProblem problem_;
  models::SensorModel sensor_;
  Expander expander_{8, 16, 4};
  SightingValue value_{8};
};

// The value per step is ln det(I + M P) for a measurement from half the range, with the covariance
// P at half the travel time. For a static target P is the prior.
TEST_F(Sighting, ValuesMeasurementsFromHalfTheRange) {
  const models::PositionVector target_m = Eigen::Vector2d::Zero();
  const Eigen::Matrix2d M = models::information(sensor_, {{-1.5, 0.0, 0.0}, 0.0}, target_m);
  const double look_nats = std::log((Eigen::Matrix2d::Identity() + M).determinant());
  for (int t = 0; t < problem_.horizon_steps; ++t) {
    EXPECT_NEAR(at(1.0, 0.0, t), look_nats * (problem_.horizon_steps - t), 1e-9);
  }
  EXPECT_EQ(at(1.0, 0.0, problem_.horizon_steps), 0.0) << "no step is left";
  problem_.cost = CostKind::kTrace;
  reset();
  const double less_m2 = 2.0 - (Eigen::Matrix2d::Identity() + M).inverse().trace();
  EXPECT_NEAR(at(1.0, 0.0, 0), less_m2 * problem_.horizon_steps, 1e-9);
}

// Each step of driving or turning at full speed delays the measurements by one step. The first is
// at the next step at the earliest. Left and right are equal.
TEST_F(Sighting, IsDelayedByDistanceAndTurn) {
  const double look = at(1.0, 0.0, 0) / problem_.horizon_steps;
  int late = 0;
  for (double away_m = 1.0; away_m < 8.0; away_m += 0.7) {
    for (double aside_rad = 0.0; aside_rad < kPi; aside_rad += 0.3) {
      const double way_s = std::max(0.0, away_m - 3.0) / 1.0;
      const double turn_s = std::max(0.0, aside_rad - 0.25 * kPi) / 2.0;
      const double steps = std::max(1.0, (way_s + turn_s) / problem_.step_s);
      for (const int t : {0, 5}) {
        const double left = problem_.horizon_steps - t;
        const double expected = steps > left ? 0.0 : look * (left + 1.0 - steps);
        EXPECT_NEAR(at(away_m, aside_rad, t), expected, 1e-9) << away_m << " m " << aside_rad;
        EXPECT_NEAR(at(away_m, -aside_rad, t), expected, 1e-9) << away_m << " m " << aside_rad;
        late += expected > 0.0 && steps > 1.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(late, 50);
}

// The value is that of the best target. Information adds up over the sensors. The longest range and
// the widest field of view determine when the target is visible.
TEST_F(Sighting, UsesTheBestTargetAndAllSensors) {
  const double near = at(4.0, 1.0, 2);
  ASSERT_GT(near, 0.0);
  SearchTarget vague = problem_.targets[0];
  vague.prior.mean = Eigen::Vector2d(8.0, 0.0);
  vague.prior.covariance *= 50.0;
  problem_.targets.insert(problem_.targets.begin(), vague);
  reset();
  const double both = at(4.0, 1.0, 2);
  problem_.targets.pop_back();
  reset();
  const double far = at(4.0, 1.0, 2);
  EXPECT_EQ(both, std::max(near, far));
  EXPECT_GT(std::abs(near - far), 1.0);

  problem_.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                       {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}}};
  models::SensorModel range = sensor_;
  range.kind = models::SensorKind::kRange;
  range.range_max_m = 5.0;
  models::SensorModel wide = sensor_;
  wide.kind = models::SensorKind::kRange;
  wide.range_max_m = 1.0;
  wide.fov_rad = kPi;
  const models::PositionVector target_m = Eigen::Vector2d::Zero();
  for (const bool turned : {false, true}) {
    problem_.sensors = {sensor_, range, wide};
    if (turned) {
      std::reverse(problem_.sensors.begin(), problem_.sensors.end());
    }
    reset();
    Eigen::Matrix2d M = Eigen::Matrix2d::Zero();  // each from half its sensor's range
    for (const models::SensorModel& each : problem_.sensors) {
      M += models::information(each, {{-0.5 * each.range_max_m, 0.0, 0.0}, 0.0}, target_m);
    }
    const double look = std::log((Eigen::Matrix2d::Identity() + M).determinant());
    EXPECT_NEAR(at(1.0, 0.0, 0), look * 12.0, 1e-9);
    // The target is 1.5 m beyond the range of 5 m and 0.5 rad outside the quarter-turn field of
    // view.
    const double steps = (1.5 + 0.5 / 2.0) / problem_.step_s;
    EXPECT_NEAR(at(6.5, 0.5 * kPi + 0.5, 0), look * (13.0 - steps), 1e-9);
    EXPECT_NEAR(at(6.5, -0.5 * kPi - 0.5, 0), look * (13.0 - steps), 1e-9);
  }
}

// A spatial target is measured from the robot's height. A robot that cannot drive gains only from
// targets that are already visible.
TEST_F(Sighting, UsesTheRobotsHeightAndReach) {
  problem_.height_m = 1.2;
  Eigen::Vector3d place_m(0.0, 0.0, 0.5);
  problem_.targets = {
      {{models::TargetKind::kStatic, 3, 0.0}, {place_m, Eigen::Matrix3d::Identity()}}};
  reset();
  const models::PositionVector target_m = place_m;
  const Eigen::Matrix3d M = models::information(sensor_, {{-1.5, 0.0, 0.0}, 1.2}, target_m);
  const double look = std::log((Eigen::Matrix3d::Identity() + M).determinant());
  EXPECT_NEAR(at(1.0, 0.0, 0), look * 12.0, 1e-9);
  problem_.controls = {{0.0, 2.0}};
  reset();
  EXPECT_NEAR(at(2.9, 0.0, 0), look * 12.0, 1e-9);
  EXPECT_EQ(at(3.1, 0.0, 0), 0.0);
  problem_.controls = {{1.0, 0.0}};
  reset();
  EXPECT_NEAR(at(2.9, 2.0, 0), look * 12.0, 1e-9)
      << "the missing ability to turn has no effect here";
}

// The value does not change if the robot and all targets are shifted.
TEST_F(Sighting, IsTranslationInvariant) {
  problem_.height_m = 0.8;
  problem_.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                       {Eigen::Vector2d(1.0, -0.5), 3.0 * Eigen::Matrix2d::Identity()}},
                      {{models::TargetKind::kStatic, 3, 0.0},
                       {Eigen::Vector3d(-2.0, 1.5, 0.2), Eigen::Matrix3d::Identity()}},
                      {{models::TargetKind::kDoubleIntegrator, 2, 0.01},
                       {Eigen::Vector4d(0.5, 3.0, -0.2, 0.1), Eigen::Matrix4d::Identity()}}};
  std::vector<double> values;
  for (const Eigen::Vector2d& shift_m :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(40.0, 0.0), Eigen::Vector2d(0.0, -30.0)}) {
    SearchProblem shifted = problem_;
    for (SearchTarget& target : shifted.targets) {
      target.prior.mean.head<2>() += shift_m;
    }
    std::size_t next = 0;
    for (std::size_t only = 0; only < shifted.targets.size(); ++only) {
      SearchProblem one = shifted;
      one.targets = {shifted.targets[only]};
      expander_.reset(one);
      value_.reset(one, expander_);
      for (const double yaw_rad : {0.0, 2.0}) {
        const double value = value_.value({shift_m.x() + 4.0, shift_m.y() - 1.0, yaw_rad}, 3);
        EXPECT_GT(value, 0.0);
        if (shift_m.isZero(0.0)) {
          values.push_back(value);
        } else {
          EXPECT_NEAR(value, values[next++], 1e-9 * value) << only << " by " << shift_m.transpose();
        }
      }
    }
  }
}

}  // namespace
}  // namespace vantage::planner
