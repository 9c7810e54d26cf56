#include "estimator/filter/distributed_filter.hpp"

#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

// Tests of the filter of one robot: comparison with a textbook filter, and late or invalid input.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace): names for tests
using vantage::test::is_near;

constexpr int kTargets = 5;

models::Viewpoint wander(int step) {
  return at(3.0 * std::cos(0.05 * step), 3.0 * std::sin(0.07 * step), wrap_to_pi(0.1 * step));
}

/// A textbook filter: one dense joint state in covariance form, with one stacked update per scan.
/// It shares only the measurement function h and its derivative with the filter under test.
struct JointKalmanFilter {
  Eigen::VectorXd mean;
  Eigen::MatrixXd P;

  void predict(const models::TargetModel& model, double dt_s) {
    const int n = model.dim();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(mean.size(), mean.size());
    Eigen::MatrixXd W = A;
    for (int m = 0; m < kTargets; ++m) {
      A.block(n * m, n * m, n, n) = model.transition(dt_s);
      W.block(n * m, n * m, n, n) = model.process_noise(dt_s);
    }
    mean = (A * mean).eval();
    P = (A * P * A.transpose() + W).eval();
  }

  void update(const models::SensorModel& sensor, const models::RobotMeasurement& look, int n) {
    const int rows = sensor.measurement_dim(2);
    const int size = kTargets * rows;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, mean.size());
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd nu(size);
    for (int m = 0; m < kTargets; ++m) {
      const auto& z = look.detections[static_cast<std::size_t>(m)].measurement;
      const Eigen::Vector2d y_m = mean.segment(n * m, 2);
      H.block(rows * m, n * m, rows, 2) = models::observation_jacobian(sensor, look.viewpoint, y_m);
      V.block(rows * m, rows * m, rows, rows) = z.V;
      nu.segment(rows * m, rows) =
          models::innovation(sensor, z.z, models::observe(sensor, look.viewpoint, y_m));
    }
    const Eigen::MatrixXd S = H * P * H.transpose() + V;
    const Eigen::MatrixXd K = P * H.transpose() * S.inverse();
    mean = (mean + K * nu).eval();
    const Eigen::MatrixXd I_KH = Eigen::MatrixXd::Identity(P.rows(), P.cols()) - K * H;
    P = (I_KH * P * I_KH.transpose() + K * V * K.transpose()).eval();
  }
};

void expect_textbook(SensorKind kind) {
  // Targets are slow and accurately known, so that h is linear over a belief. Otherwise the filter
  // would differ from an extended Kalman filter.
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 1e-5};
  const models::SensorModel sensor = test::far_sighted(kind);
  std::mt19937_64 rng(11);
  std::vector<Eigen::Vector2d> truth;
  std::vector<Gaussian> start;
  JointKalmanFilter joint{Eigen::VectorXd(4 * kTargets),
                          Eigen::MatrixXd::Zero(4 * kTargets, 4 * kTargets)};
  for (int m = 0; m < kTargets; ++m) {
    truth.push_back({8.0 + 2.0 * m, 6.0 - 5.0 * m});
    Gaussian g{models::StateVector::Zero(4), 0.01 * models::StateMatrix::Identity(4, 4)};
    g.covariance.bottomRightCorner(2, 2) = 4e-4 * Eigen::Matrix2d::Identity();
    g.mean.head(2) = truth.back() + 0.1 * test::normal_vector(2, rng);
    start.push_back(g);
    joint.mean.segment(4 * m, 4) = g.mean;
    joint.P.block(4 * m, 4 * m, 4, 4) = g.covariance;
  }
  DistributedFilter filter(open_spec(model, sensor, kTargets));
  filter.rebase(test::prior(instant(0), start));
  double worst = 0.0;
  for (int k = 1; k <= 1000; ++k) {
    const auto look = look_at(sensor, instant(k), wander(k), truth, rng);
    take_step(filter, instant(k), wander(k), {look});
    joint.predict(model, 0.5);
    joint.update(sensor, look, 4);
    for (int m = 0; m < kTargets; ++m) {
      const Gaussian g = known(filter, m);
      worst = std::max(worst, (g.mean - joint.mean.segment(4 * m, 4)).cwiseAbs().maxCoeff());
      const Eigen::MatrixXd difference = g.covariance - joint.P.block(4 * m, 4 * m, 4, 4);
      worst = std::max(worst, difference.cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LE(worst, 1e-9);
  ::testing::Test::RecordProperty("worst_difference", std::to_string(worst));
}

TEST(DistributedFilter, EqualsTheJointKalmanFilterForOneRobot) {
  expect_textbook(SensorKind::kPosition);
}

TEST(DistributedFilter, EqualsTheJointExtendedKalmanFilterForOneRobot) {
  expect_textbook(SensorKind::kRangeBearing);
}

TEST(DistributedFilter, IsConsistentOnItsOwnModelForOneRobot) {
  // The truth is linear and Gaussian from the discovery on, so the summed squared error is χ²
  // distributed.
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.02};
  const models::SensorModel sensor = test::far_sighted(SensorKind::kPosition);
  double nees = 0.0;
  for (unsigned run = 0; run < 100; ++run) {
    std::mt19937_64 rng(1000 + run);
    DistributedFilter filter(open_spec(model, sensor, kTargets));
    std::vector<Eigen::Vector2d> truth;
    for (int m = 0; m < kTargets; ++m) {
      truth.emplace_back(5.0 * test::normal_vector(2, rng));
    }
    for (int k = 1; k <= 40; ++k) {
      for (Eigen::Vector2d& y_m : truth) {
        y_m += std::sqrt(0.02 * 0.5) * test::normal_vector(2, rng);
      }
      // Every third step has no scan, so that prediction is tested, too.
      std::vector<models::RobotMeasurement> looks;
      if (k % 3 != 0) {
        looks.push_back(look_at(sensor, instant(k), wander(k), truth, rng));
      }
      take_step(filter, instant(k), wander(k), looks);
    }
    for (int m = 0; m < kTargets; ++m) {
      const Gaussian g = known(filter, m);
      const Eigen::Vector2d error = g.mean - truth[static_cast<std::size_t>(m)];
      nees += error.dot(Eigen::Matrix2d(g.covariance).inverse() * error);
    }
  }
  const double dof = 100.0 * kTargets * 2.0;
  EXPECT_GE(nees, test::chi2_quantile(dof, -1.96));
  EXPECT_LE(nees, test::chi2_quantile(dof, 1.96));
}

TEST(DistributedFilter, UsesAMeasurementBetweenStepsAtItsTime) {
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.5};
  const models::SensorModel sensor = test::far_sighted(SensorKind::kPosition);
  std::mt19937_64 rng(5);
  const Gaussian start{Eigen::Vector4d(1.0, 2.0, 0.3, -0.2), Eigen::Matrix4d::Identity()};
  DistributedFilter filter(open_spec(model, sensor, 1));
  filter.rebase(test::prior(instant(0), {start}));
  const Time between = instant(0) + from_seconds(0.2);
  const auto look = look_at(sensor, between, at(0, 0), {Eigen::Vector2d(1.1, 1.9)}, rng);
  take_step(filter, instant(1), at(0, 0), {look});

  Gaussian expected = models::predict(start, model.transition(0.2), model.process_noise(0.2));
  const auto& z = look.detections[0].measurement;
  models::MeasurementJacobian H = models::MeasurementJacobian::Zero(2, 4);
  H.leftCols(2).setIdentity();
  expected = models::update(expected, H, z.V, z.z - expected.mean.head(2));
  expected = models::predict(expected, model.transition(0.3), model.process_noise(0.3));
  EXPECT_TRUE(is_near(known(filter, 0).mean, expected.mean, 1e-12));
  EXPECT_TRUE(is_near(known(filter, 0).covariance, expected.covariance, 1e-12));
}

/// Two filters over the same world; one of them receives the observations of `late_steps` with a
/// delay of `delay` steps.
class LateMeasurements : public ::testing::Test {
 protected:
  void run(int delay, int history_steps) {
    const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.01};
    models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
    sensor.range_max_m = 6.0;  // m; not all targets are always in view
    FilterSpec spec = open_spec(model, sensor, 3);
    spec.sensor = sensor;
    spec.estimator.detection_probability = 0.9;
    spec.communication_range_m = 100.0;
    spec.history_steps = history_steps;
    DistributedFilter timely(spec);
    DistributedFilter late(spec);
    std::mt19937_64 rng(23);
    const std::vector<Eigen::Vector2d> truth = {{4.0, 1.0}, {-3.0, 3.0}, {0.0, -5.0}};
    std::vector<models::RobotMeasurement> held;
    for (int k = 1; k <= 30; ++k) {
      models::RobotMeasurement look = look_at(sensor, instant(k), wander(k), truth, rng);
      std::erase_if(look.detections, [&](const models::Detection& d) {
        return k % 4 == 1 ||  // missed detections
               !models::in_view(sensor, wander(k), truth[static_cast<std::size_t>(d.target_id)]);
      });
      models::RobotBelief teammate =
          test::prior(instant(k - 1),
                      {{Eigen::Vector4d(4.1, 1.1, 0.0, 0.0), 0.5 * Eigen::Matrix4d::Identity()}});
      teammate.robot = "Q2";
      teammate.degree = 1;
      const std::vector<models::RobotBelief> received = {teammate};
      a_ = take_step(timely, instant(k), wander(k), {look}, received);
      std::vector<models::RobotMeasurement> arrived;
      if (k % 7 == 3) {
        held.push_back(look);
      } else {
        arrived.push_back(look);
      }
      if (!held.empty() && held.front().stamp.time <= instant(k - delay)) {
        arrived.push_back(held.front());
        held.erase(held.begin());
      }
      b_ = take_step(late, instant(k), wander(k), arrived, received);
    }
    counters_ = late.counters();
    timely_counters_ = timely.counters();
  }

  models::RobotBelief a_;
  models::RobotBelief b_;
  FilterCounters counters_;
  FilterCounters timely_counters_;
};

TEST_F(LateMeasurements, GiveTheSameBeliefAsTimelyOnes) {
  run(3, 8);
  EXPECT_EQ(counters_.late_measurements, 4);
  EXPECT_EQ(counters_.too_late_measurements, 0);
  EXPECT_GT(timely_counters_.missed_detections, 0);
  ASSERT_EQ(a_.targets.size(), b_.targets.size());
  ASSERT_FALSE(a_.targets.empty());
  for (std::size_t m = 0; m < a_.targets.size(); ++m) {
    // The results are not bit-identical: the rounding of Eigen's AVX kernels depends on the memory
    // address modulo 32.
    const models::Information& a = a_.targets[m].information;
    const models::Information& b = b_.targets[m].information;
    const double size = a.matrix.cwiseAbs().maxCoeff();
    EXPECT_TRUE(is_near(a.matrix, b.matrix, 1e-9 * size));
    EXPECT_TRUE(is_near(a.vector, b.vector, 1e-9 * size));
    EXPECT_EQ(a_.targets[m].last_seen, b_.targets[m].last_seen);
  }
  EXPECT_EQ(a_.last_seen_utime, b_.last_seen_utime);
}

TEST_F(LateMeasurements, AreCountedAndDroppedIfOlderThanTheHistory) {
  run(3, 3);
  EXPECT_EQ(counters_.late_measurements, 0);
  EXPECT_EQ(counters_.too_late_measurements, 4);
}

TEST(DistributedFilter, DiscoversWithTheNoiseOfTheFirstMeasurement) {
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.001};
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(3);
  DistributedFilter filter(open_spec(model, sensor, 1));
  const auto look = look_at(sensor, instant(0), at(1, 2, 0.4), {Eigen::Vector2d(4.0, 6.0)}, rng);
  const auto belief = take_step(filter, instant(0), at(1, 2, 0.4), {look});
  ASSERT_EQ(belief.targets.size(), 1u);
  EXPECT_EQ(belief.targets[0].last_seen, instant(0));
  const Gaussian g = known(filter, 0);
  const auto& z = look.detections[0].measurement;
  const double range_m = z.z(0);
  const double bearing_rad = 0.4 + z.z(1);
  // The mean is the measured position, except for the curvature of the arc, 2 cm.
  EXPECT_NEAR(g.mean(0), 1.0 + range_m * std::cos(bearing_rad), 0.03);
  EXPECT_NEAR(g.mean(1), 2.0 + range_m * std::sin(bearing_rad), 0.03);
  // Across the line of sight the spread is r σ_b, along it σ_r.
  Eigen::Matrix2d axes;
  axes << std::cos(bearing_rad), -std::sin(bearing_rad), std::sin(bearing_rad),
      std::cos(bearing_rad);
  const Eigen::Vector2d variances(0.15 * 0.15, std::pow(range_m * radians(5.0), 2));
  const Eigen::Matrix2d expected = axes * variances.asDiagonal() * axes.transpose();
  EXPECT_TRUE(is_near(g.covariance.topLeftCorner(2, 2), expected, 0.005));
  EXPECT_TRUE(
      is_near(g.covariance.bottomRightCorner(2, 2), 0.25 * Eigen::Matrix2d::Identity(), 1e-9));
}

TEST(DistributedFilter, WaitsForMoreRangesBeforeADiscovery) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRange);
  std::mt19937_64 rng(3);
  DistributedFilter filter(open_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1));
  const auto look = look_at(sensor, instant(0), at(0, 0), {Eigen::Vector2d(4.0, 6.0)}, rng);
  EXPECT_TRUE(take_step(filter, instant(0), at(0, 0), {look}).targets.empty());
  EXPECT_EQ(filter.counters().undiscoverable, 0);
}

TEST(DistributedFilter, CountsEveryUnusedInput) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(4);
  DistributedFilter filter(gated_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1, 4.0));
  const auto good = look_at(sensor, instant(0), at(0, 0), {Eigen::Vector2d(4.0, 0.0)}, rng);
  take_step(filter, instant(0), at(0, 0), {good});
  const Gaussian before = known(filter, 0);

  auto jammed = good;
  jammed.stamp.time = instant(1);
  jammed.jammed = true;
  auto future = good;
  future.stamp.time = instant(9);
  auto stranger = good;
  stranger.stamp.time = instant(1);
  stranger.detections[0].target_id = 7;
  auto short_z = good;
  short_z.stamp.time = instant(1);
  short_z.detections[0].measurement.z = Eigen::Matrix<double, 1, 1>(4.0);
  auto far_off = good;
  far_off.stamp.time = instant(1);
  far_off.detections[0].measurement.z = Eigen::Vector2d(9.0, 0.0);
  take_step(filter, instant(1), at(0, 0), {jammed, future, stranger, short_z, far_off});
  take_step(filter, instant(1), at(0, 0), {});

  EXPECT_EQ(filter.counters().jammed_looks, 1);
  EXPECT_EQ(filter.counters().future_measurements, 1);
  EXPECT_EQ(filter.counters().unknown_ids, 1);
  EXPECT_EQ(filter.counters().malformed_detections, 1);
  EXPECT_EQ(filter.counters().gated, 1);
  EXPECT_EQ(filter.counters().steps_out_of_order, 1);
  EXPECT_EQ(filter.counters().named().size(), 6u);
  EXPECT_TRUE(is_near(known(filter, 0).mean, before.mean, 1e-12));
}

// A starting filter receives a teammate's observation and a belief that already contains this
// observation. The information must count once.
TEST(DistributedFilter, CountsAMeasurementOnceIfABeliefContainsItToo) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(14);
  FilterSpec spec = open_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1);
  spec.communication_range_m = 100.0;
  spec.team = {{"Q1", sensor}, {"Q2", sensor}};
  models::RobotMeasurement look =
      look_at(sensor, instant(0), at(0, 0), {Eigen::Vector2d(4.0, 0.0)}, rng);
  look.robot = "Q2";
  FilterSpec of_teammate = spec;
  of_teammate.robot = "Q2";
  DistributedFilter teammate(of_teammate);
  const models::RobotBelief given = take_step(teammate, instant(0), at(0, 0), {look});
  DistributedFilter filter(spec);
  take_step(filter, instant(1), at(0, 0), {look}, {given});
  EXPECT_TRUE(is_near(known(filter, 0).covariance, known(teammate, 0).covariance, 1e-9));
}

TEST(DistributedFilter, StepsWithoutAllocating) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "the allocation counter is inert under sanitizers";
  }
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.001};
  models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(9);
  FilterSpec spec = open_spec(model, sensor, kTargets);
  spec.communication_range_m = 100.0;
  spec.estimator.detection_probability = 0.9;
  spec.estimator.gate_sigma = 5.0;
  spec.team = {{"Q1", sensor}, {"Q2", sensor}, {"Q3", sensor}};
  DistributedFilter filter(spec);
  std::vector<Eigen::Vector2d> truth;
  std::vector<Gaussian> start;
  for (int m = 0; m < kTargets; ++m) {
    truth.push_back({4.0 + m, 3.0 - m});
    start.push_back({models::StateVector::Zero(4), models::StateMatrix::Identity(4, 4)});
    start.back().mean.head(2) = truth.back();
  }
  filter.rebase(test::prior(instant(0), start));
  for (int k = 1; k <= 20; ++k) {
    auto look = look_at(sensor, instant(k), wander(k), truth, rng);
    look.detections.pop_back();  // one visible target is not reported
    auto seen = look_at(sensor, instant(k), at(truth[0].x() + 0.3, truth[0].y()), truth, rng);
    seen.robot = "Q2";  // almost above a target
    models::RobotBelief teammate = test::prior(instant(k - 1), start);
    teammate.robot = "Q2";
    const models::RobotMeasurement* looks[] = {&look, &seen};
    const models::RobotBelief* beliefs[] = {&teammate};
    const StepInput input{instant(k), wander(k), looks, beliefs};
    const vantage::test::AllocationCounter allocations;
    filter.advance(input);
    EXPECT_EQ(allocations.count(), 0u) << "step " << k;
  }
  EXPECT_GT(filter.counters().missed_detections, 0);
}

TEST(DistributedFilter, MarksTheObservedCells) {
  models::SensorModel sensor;
  sensor.range_max_m = 3.0;
  FilterSpec spec = open_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1);
  spec.sensor = sensor;
  spec.estimator.grid_resolution_m = 0.5;
  DistributedFilter filter(spec);
  models::RobotMeasurement look;
  look.stamp.time = instant(0);
  look.viewpoint = at(0, 0);
  const auto belief = take_step(filter, instant(0), at(0, 0), {look});
  const auto seen = [&](double x_m, double y_m) {
    const int cell = belief.grid.index_of({x_m, y_m});
    return belief.last_seen_utime[static_cast<std::size_t>(cell)];
  };
  EXPECT_EQ(seen(1.2, 1.2), to_utime(instant(0)));
  EXPECT_EQ(seen(4.2, 1.2), models::VisibilityGrid::kNeverSeen);
}

TEST(FilterSpec, RefusesAnUnknownRobot) { EXPECT_THROW(filter_spec({}, "Q1"), UsageError); }

// An observation from before a rebase is always too late.
TEST(DistributedFilter, IgnoresMeasurementsBeforeTheLastRebase) {
  const models::TargetModel walk{models::TargetKind::kRandomWalk, 2, 0.1};
  models::SensorModel position;
  position.kind = models::SensorKind::kPosition;
  std::mt19937_64 rng(12);
  DistributedFilter filter(test::open_spec(walk, position, 1));
  const std::vector<models::Gaussian> start = {
      {Eigen::Vector2d(0.0, 0.0), 0.2 * Eigen::Matrix2d::Identity()}};
  const models::Gaussian given{Eigen::Vector2d(3.0, 1.0), 0.04 * Eigen::Matrix2d::Identity()};
  const std::vector<Eigen::Vector2d> truth_m = {{0.5, 0.5}};
  filter.rebase(test::prior(instant(0), start));
  for (int rebase = 1; rebase <= 2; ++rebase) {
    const int first = 4 * (rebase - 1);
    for (int step = first + 1; step <= first + 3; ++step) {
      const Time seen = instant(step) - from_seconds(0.2);
      test::take_step(filter, instant(step), test::at(0, 0),
                      {test::look_at(position, seen, test::at(0, 0), truth_m, rng)});
    }
    EXPECT_EQ(filter.counters().late_measurements, rebase - 1);
    filter.rebase(test::prior(instant(first + 3), {given}));
    // Two late observations: one is two steps old, one is from the step that ended at the rebase.
    for (const double ago_s : {1.1, 0.2}) {
      const Time seen = instant(first + 3) - from_seconds(ago_s);
      DistributedFilter other = filter;
      test::take_step(other, instant(first + 4), test::at(0, 0),
                      {test::look_at(position, seen, test::at(0, 0), truth_m, rng)});
      EXPECT_EQ(other.counters().too_late_measurements, 1) << ago_s;
      EXPECT_EQ(other.counters().late_measurements, rebase - 1) << ago_s;
      EXPECT_TRUE(is_near(test::known(other, 0).mean, given.mean, 1e-9)) << ago_s;
    }
    // After the first step since the rebase, a late observation can be applied.
    test::take_step(filter, instant(first + 4), test::at(0, 0), {});
    DistributedFilter other = filter;
    const Time late = instant(first + 3) + from_seconds(0.3);
    test::take_step(other, instant(first + 5), test::at(0, 0),
                    {test::look_at(position, late, test::at(0, 0), truth_m, rng)});
    EXPECT_EQ(other.counters().late_measurements, rebase);
    filter = other;
    filter.rebase(test::prior(instant(first + 4) + Duration{1}, start));
  }
}

TEST(FilterCounters, AreListedWhenNonZero) {
  FilterCounters counters;
  std::vector<std::pair<std::string, std::int64_t>> expected, named;
  const auto count = [&](const char* name, std::int64_t& counter) {
    counter = 1 + static_cast<std::int64_t>(expected.size());
    expected.emplace_back(name, counter);
  };
  count("steps_out_of_order", counters.steps_out_of_order);
  count("stale_beliefs", counters.stale_beliefs);
  count("future_beliefs", counters.future_beliefs);
  count("malformed_beliefs", counters.malformed_beliefs);
  count("grid_mismatches", counters.grid_mismatches);
  count("repeated_looks", counters.repeated_looks);
  count("late_measurements", counters.late_measurements);
  count("too_late_measurements", counters.too_late_measurements);
  count("future_measurements", counters.future_measurements);
  count("jammed_looks", counters.jammed_looks);
  count("malformed_detections", counters.malformed_detections);
  count("surplus_detections", counters.surplus_detections);
  count("gated", counters.gated);
  count("unknown_ids", counters.unknown_ids);
  count("undiscoverable", counters.undiscoverable);
  count("singular", counters.singular);
  counters.out_of_range_beliefs = counters.out_of_range_looks = counters.missed_detections = 99;
  for (const models::NamedCount& each : counters.named()) {
    named.emplace_back(each.name, each.count);
  }
  EXPECT_EQ(named, expected);
}

}  // namespace
}  // namespace vantage::estimator
