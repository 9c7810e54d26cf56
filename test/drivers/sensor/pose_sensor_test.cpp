#include "drivers/sensor/pose_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "test/sim/lab_scenario.hpp"

namespace vantage::drivers {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

models::MocapBody body(const std::string& name, const Pose2& pose, double height_m) {
  models::MocapBody out;
  out.name = name;
  out.world_from_body = lift(pose, height_m);
  return out;
}

/// Returns a frame with Q1 at (2, 4), 1 m high, heading along +x, and one rover.
models::MocapFrame frame_with(const Pose2& rover, Time time = kStart) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.bodies = {body("Q1", {2.0, 4.0, 0.0}, 1.0), body("ROVER1", rover, 0.0)};
  return frame;
}

scenario::Scenario scenario_with(models::SensorKind kind) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.robots[0].sensor.kind = kind;
  return scenario;
}

// Tests the noise statistically. The measurement error, whitened by its covariance, is standard
// normal. Its squared norm is χ² with one degree of freedom per row. The mean of n such values has
// σ = √(2 d / n).
class EverySensor : public ::testing::TestWithParam<models::SensorKind> {};

TEST_P(EverySensor, HasItsStatedNoise) {
  const scenario::Scenario scenario = scenario_with(GetParam());
  const models::SensorModel& sensor = scenario.robots[0].sensor;
  const PoseSensor driver(scenario, "Q1");
  const models::Viewpoint from{{2.0, 4.0, 0.0}, 1.0};
  const models::PositionVector target_m = Eigen::Vector2d(2.5, 4.3);
  const models::MeasurementVector expected = models::observe(sensor, from, target_m);
  const auto dim = expected.size();
  constexpr int kLooks = 20000;
  double chi2 = 0.0;
  models::MeasurementVector mean = models::MeasurementVector::Zero(dim);
  for (int k = 0; k < kLooks; ++k) {
    const auto seen = driver.measure(frame_with({2.5, 4.3, 0.0}, kStart + Duration{k}), false);
    ASSERT_TRUE(seen);
    ASSERT_EQ(seen->detections.size(), 1u);
    const models::Measurement& measured = seen->detections[0].measurement;
    const Eigen::LLT<Eigen::MatrixXd> root(Eigen::MatrixXd(measured.V));
    const Eigen::VectorXd white =
        root.matrixL().solve(Eigen::VectorXd(models::innovation(sensor, measured.z, expected)));
    chi2 += white.squaredNorm() / kLooks;
    mean += white / kLooks;
  }
  const auto rows = static_cast<double>(dim);
  EXPECT_NEAR(chi2, rows, 5.0 * std::sqrt(2.0 * rows / kLooks));
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 5.0 / std::sqrt(kLooks));
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySensor,
                         ::testing::Values(models::SensorKind::kPosition,
                                           models::SensorKind::kRange, models::SensorKind::kBearing,
                                           models::SensorKind::kRangeBearing,
                                           models::SensorKind::kCamera));

// The target moves by 4 cm and −3 cm in 0.1 s: (0.4, −0.3) m/s.
TEST(PoseSensor, MeasuresVelocityFromAnEarlierFrame) {
  scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeRate);
  models::SensorModel& sensor = scenario.robots[0].sensor;
  sensor.own[0] = 0.05;
  const PoseSensor driver(scenario, "Q1");
  ASSERT_TRUE(driver.measures_velocity());
  const models::Viewpoint from{{2.0, 4.0, 0.0}, 1.0};
  const Eigen::Vector2d target_m(2.5, 4.3);
  const models::MeasurementVector expected =
      models::observe(sensor, from, target_m, Eigen::Vector2d(0.4, -0.3));
  constexpr int kLooks = 4000;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int k = 0; k < kLooks; ++k) {
    const Time now = kStart + Duration{k};
    const models::MocapFrame earlier =
        frame_with({2.46, 4.33, 0.0}, now - std::chrono::milliseconds(100));
    const auto seen = driver.measure(frame_with({2.5, 4.3, 0.0}, now), false, &earlier);
    ASSERT_EQ(seen->detections.size(), 1u);
    mean += seen->detections[0].measurement.z / kLooks;
  }
  EXPECT_NEAR(mean(0), expected(0), 5.0 * 0.3 / std::sqrt(kLooks));
  EXPECT_NEAR(mean(1), expected(1), 5.0 * 0.05 / std::sqrt(kLooks));
}

TEST(PoseSensor, ReportsNoVelocityWithoutAnEarlierPose) {
  const PoseSensor driver(scenario_with(models::SensorKind::kRangeRate), "Q1");
  const models::MocapFrame frame = frame_with({2.5, 4.3, 0.0});
  EXPECT_TRUE(driver.measure(frame, false)->detections.empty());
  models::MocapFrame earlier = frame_with({2.5, 4.3, 0.0}, kStart - Duration{100'000});
  EXPECT_EQ(driver.measure(frame, false, &earlier)->detections.size(), 1u);
  earlier.bodies[1].occluded = true;
  EXPECT_TRUE(driver.measure(frame, false, &earlier)->detections.empty());
  EXPECT_TRUE(driver.measure(frame, false, &frame)->detections.empty()) << "same instant";
}

TEST(PoseSensor, DetectsTargetsInRangeInTheFieldOfViewAndInSight) {
  scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeBearing);
  scenario.robots[0].sensor.fov_rad = radians(90.0);
  scenario.world.obstacles.push_back({{{2.4, 3.9}, {2.5, 4.1}}, 0.5});
  const PoseSensor sensor(scenario, "Q1");
  const auto sees = [&](double x_m, double y_m) {
    return !sensor.measure(frame_with({x_m, y_m, 0.0}), false)->detections.empty();
  };
  EXPECT_TRUE(sees(2.5, 4.3));
  EXPECT_FALSE(sees(2.0, 4.5)) << "outside the field of view";
  EXPECT_FALSE(sees(2.8, 4.7)) << "beyond 1 m";
  EXPECT_FALSE(sees(2.8, 4.0)) << "behind a box";
}

TEST(PoseSensor, IgnoresOccludedTargetsAndMeasuresNothingWithoutItsOwnPose) {
  const PoseSensor sensor(scenario_with(models::SensorKind::kRangeBearing), "Q1");
  models::MocapFrame frame = frame_with({2.5, 4.3, 0.0});
  frame.bodies[1].occluded = true;
  EXPECT_TRUE(sensor.measure(frame, false)->detections.empty());
  frame.bodies[0].occluded = true;
  EXPECT_FALSE(sensor.measure(frame, false));
  frame.bodies.erase(frame.bodies.begin());
  EXPECT_FALSE(sensor.measure(frame, false));
}

TEST(PoseSensor, DoesNotMeasureWhenJammed) {
  const PoseSensor sensor(scenario_with(models::SensorKind::kRangeBearing), "Q1");
  const auto jammed = sensor.measure(frame_with({2.5, 4.3, 0.0}), true);
  ASSERT_TRUE(jammed);
  EXPECT_TRUE(jammed->jammed);
  EXPECT_TRUE(jammed->detections.empty());
}

TEST(PoseSensor, NoiseDependsOnTheTime) {
  scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeBearing);
  const auto z = [&](const std::string& robot, Time time) {
    models::MocapFrame frame = frame_with({2.5, 4.3, 0.0}, time);
    frame.bodies.push_back(body("Q2", {2.0, 4.0, 0.0}, 1.5));
    return Eigen::VectorXd(
        PoseSensor(scenario, robot).measure(frame, false)->detections.at(0).measurement.z);
  };
  const Eigen::VectorXd first = z("Q1", kStart);
  EXPECT_EQ(first, z("Q1", kStart));
  EXPECT_NE(first, z("Q1", kStart + Duration{500'000}));
  EXPECT_NE(first, z("Q2", kStart));
  scenario.seed += 1;
  EXPECT_NE(first, z("Q1", kStart));
}

/// Mean and variance of the number of detections in 5000 observations of one target in view.
struct Reports {
  static constexpr int kLooks = 5000;
  double mean = 0.0;
  double variance = 0.0;

  explicit Reports(const models::DetectionModel& detection) {
    scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeBearing);
    scenario.robots[0].detection = detection;
    const PoseSensor sensor(scenario, "Q1");
    double squares = 0.0;
    for (int k = 0; k < kLooks; ++k) {
      const auto seen = sensor.measure(frame_with({2.5, 4.3, 0.0}, kStart + Duration{k}), false);
      const auto count = static_cast<double>(seen->detections.size());
      mean += count / kLooks;
      squares += count * count / kLooks;
    }
    variance = squares - mean * mean;
  }
};

// Detections follow a Bernoulli distribution: mean p, variance p (1 − p).
TEST(PoseSensor, MissesDetectionsAtTheConfiguredRate) {
  const Reports reports({0.7, 0.0, true});
  EXPECT_NEAR(reports.mean, 0.7, 5.0 * std::sqrt(0.21 / Reports::kLooks));
  EXPECT_NEAR(reports.variance, 0.21, 0.01);
}

// The number of false alarms follows a Poisson distribution: its mean and variance are λ. The
// estimate of the variance has σ² = (λ + 2 λ²) / n. The target adds p to the mean and p (1 − p) to
// the variance.
TEST(PoseSensor, ReportsPoissonFalseAlarms) {
  const double lambda = 2.0;
  const Reports reports({0.9, lambda, false});
  EXPECT_NEAR(reports.mean, lambda + 0.9, 5.0 * std::sqrt((lambda + 0.09) / Reports::kLooks));
  EXPECT_NEAR(reports.variance, lambda + 0.09,
              5.0 * std::sqrt((lambda + 2.0 * lambda * lambda) / Reports::kLooks));
}

TEST(PoseSensor, HidesWhichDetectionIsATarget) {
  scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeBearing);
  scenario.robots[0].detection = {1.0, 3.0, false};
  const PoseSensor sensor(scenario, "Q1");
  scenario.robots[0].detection = {};
  const PoseSensor naming(scenario, "Q1");
  int several = 0;
  double place = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const models::MocapFrame frame = frame_with({2.5, 4.3, 0.0}, kStart + Duration{k});
    const auto seen = sensor.measure(frame, false)->detections;
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
      return a.measurement.z(0) < b.measurement.z(0);
    }));
    // One of the detections is that of the target. It equals the detection with known ids.
    const auto own = naming.measure(frame, false)->detections.at(0).measurement.z;
    const auto at = std::find_if(seen.begin(), seen.end(),
                                 [&](const auto& each) { return each.measurement.z == own; });
    ASSERT_NE(at, seen.end());
    for (const models::Detection& each : seen) {
      EXPECT_EQ(each.target_id, models::kNoTargetId);
      EXPECT_EQ(each.measurement.V, at->measurement.V);
    }
    several += seen.size() > 1 ? 1 : 0;
    place += at == seen.begin() ? 1.0 : 0.0;
  }
  EXPECT_GT(several, 1500);
  EXPECT_GT(place, 200.0);
  EXPECT_LT(place, 1800.0);
}

TEST(PoseSensor, ReproducesFalseAlarmsPerInstant) {
  scenario::Scenario scenario = scenario_with(models::SensorKind::kRangeBearing);
  scenario.robots[0].detection = {0.9, 5.0, false};
  const PoseSensor sensor(scenario, "Q1");
  const auto seen = [&](Time time) {
    return sensor.measure(frame_with({2.5, 4.3, 0.0}, time), false)->detections;
  };
  const auto first = seen(kStart);
  const auto again = seen(kStart);
  const auto later = seen(kStart + Duration{500'000});
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].measurement.z, again[i].measurement.z);
  }
  EXPECT_NE(first.at(0).measurement.z, later.at(0).measurement.z);
}

TEST(PoseSensor, RefusesAnUnknownRobot) {
  EXPECT_THROW(PoseSensor(test::lab_scenario(), "Q9"), UsageError);
}

TEST(Interpolate, MovesStraightAndTurnsTheShortestAngle) {
  const models::MocapFrame before = frame_with({1.0, 1.0, 3.0}, kStart);
  const models::MocapFrame after = frame_with({2.0, 3.0, -3.0}, kStart + Duration{20'000});
  const models::MocapFrame between = interpolate(before, after, kStart + Duration{5'000});
  EXPECT_EQ(between.stamp.time, kStart + Duration{5'000});
  const Pose2 rover = flatten(between.find("ROVER1")->world_from_body);
  EXPECT_NEAR(rover.x_m, 1.25, 1e-12);
  EXPECT_NEAR(rover.y_m, 1.5, 1e-12);
  EXPECT_NEAR(rover.yaw_rad, 3.0 + 0.25 * (2.0 * kPi - 6.0), 1e-9);
}

TEST(Interpolate, RequiresABodyInBothFrames) {
  models::MocapFrame before = frame_with({1.0, 1.0, 3.0}, kStart);
  const models::MocapFrame after = frame_with({2.0, 3.0, -3.0}, kStart + Duration{20'000});
  before.bodies[1].occluded = true;
  EXPECT_TRUE(interpolate(before, after, kStart).find("ROVER1")->occluded);
  before.bodies.pop_back();
  EXPECT_TRUE(interpolate(before, after, kStart).find("ROVER1")->occluded);
  EXPECT_FALSE(interpolate(before, after, kStart).find("Q1")->occluded);
}

}  // namespace
}  // namespace vantage::drivers
