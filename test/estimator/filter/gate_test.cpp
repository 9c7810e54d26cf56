#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

// Tests detections that are outside the gate of their target.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace): names for tests
using vantage::test::is_near;

// The ids of two stationary targets are swapped in every tenth scan.
TEST(DistributedFilter, GateRejectsSwappedIds) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  const std::vector<Eigen::Vector2d> truth = {{4.0, 0.0}, {0.0, 4.0}};
  for (const bool is_gated : {false, true}) {
    std::mt19937_64 rng(5);
    DistributedFilter filter(
        gated_spec({TargetKind::kRandomWalk, 2, 0.001}, sensor, 2, is_gated ? 5.0 : 0.0));
    double worst_m = 0.0;
    for (int k = 0; k < 40; ++k) {
      auto look = look_at(sensor, instant(k), at(0, 0), truth, rng);
      if (k % 10 == 9) {
        std::swap(look.detections[0].target_id, look.detections[1].target_id);
      }
      take_step(filter, instant(k), at(0, 0), {look});
      for (int m = 0; m < 2; ++m) {
        const Eigen::Vector2d mean_m = known(filter, m).mean;
        worst_m = std::max(worst_m, (mean_m - truth[static_cast<std::size_t>(m)]).norm());
      }
    }
    EXPECT_EQ(worst_m < 0.65, is_gated) << worst_m;
    EXPECT_EQ(filter.counters().gated, is_gated ? 8 : 0);
  }
}

// A false alarm with an unused id starts a track. The first detection of the true target is gated,
// the second detection replaces the track.
TEST(DistributedFilter, GateDropsATrackOfAFalseId) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(6);
  DistributedFilter filter(gated_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1, 4.0));
  take_step(filter, instant(0), at(0, 0),
            {look_at(sensor, instant(0), at(0, 0), {Eigen::Vector2d(-3.0, -3.0)}, rng)});
  for (int k = 1; k <= 2; ++k) {
    EXPECT_LT(known(filter, 0).mean(0), -1.0);
    take_step(filter, instant(k), at(0, 0),
              {look_at(sensor, instant(k), at(0, 0), {Eigen::Vector2d(4.0, 0.0)}, rng)});
  }
  EXPECT_NEAR(known(filter, 0).mean(0), 4.0, 0.6);
  EXPECT_EQ(filter.counters().gated, 1);
}

// A detection outside the gate has a wrong id, or its target moved unexpectedly. The covariance
// covers both hypotheses until the next detection confirms one of them.
TEST(DistributedFilter, GateKeepsBothHypothesesUntilTheNextMeasurement) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.001};
  const Eigen::Vector2d here_m(4.0, 0.0);
  for (const Eigen::Vector2d& there_m : {Eigen::Vector2d(0.0, 4.0), Eigen::Vector2d(7.0, -2.0)}) {
    for (const bool was_right : {false, true}) {
      std::mt19937_64 rng(8);
      const auto look = [&](int k, const Eigen::Vector2d& seen_m) {
        return look_at(sensor, instant(k), at(0, 0), {seen_m}, rng);
      };
      DistributedFilter filter(gated_spec(model, sensor, 1, 4.0));
      for (int k = 0; k < 10; ++k) {
        take_step(filter, instant(k), at(0, 0), {look(k, here_m)});
      }
      const Gaussian sure = models::predict(known(filter, 0), model, 0.5);
      const models::RobotMeasurement strange = look(10, there_m);
      take_step(filter, instant(10), at(0, 0), {strange});
      const Gaussian doubted = known(filter, 0);
      EXPECT_EQ(filter.counters().gated, 1);
      EXPECT_TRUE(is_near(doubted.mean, sure.mean, 1e-6));
      const Gaussian there =
          models::to_gaussian(*discover(filter.spec().estimator, sensor, at(0, 0),
                                        strange.detections[0].measurement))
              .value();
      const Eigen::Vector4d off = there.mean - sure.mean;
      EXPECT_TRUE(is_near(doubted.covariance,
                          sure.covariance + 0.5 * (there.covariance + off * off.transpose()),
                          1e-6));
      take_step(filter, instant(11), at(0, 0), {look(11, was_right ? there_m : here_m)});
      EXPECT_EQ(filter.counters().gated, 1);
      EXPECT_LT((known(filter, 0).mean.head<2>() - (was_right ? there_m : here_m)).norm(), 1.2);
      EXPECT_LT(known(filter, 0).covariance.topLeftCorner(2, 2).trace(), 1.0);
    }
  }
}

// The belief of a teammate that has not received the gated detection does not remove the second
// hypothesis.
TEST(DistributedFilter, GateKeepsBothHypothesesDespiteATeammatesBelief) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRangeBearing);
  std::mt19937_64 rng(13);
  FilterSpec spec = gated_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1, 4.0);
  spec.communication_range_m = 100.0;
  DistributedFilter filter(spec);
  const Eigen::Vector2d there_m(0.0, 4.0);
  const std::vector<Gaussian> sure = {
      {Eigen::Vector2d(4.0, 0.0), 0.001 * Eigen::Matrix2d::Identity()}};
  filter.rebase(test::prior(instant(0), sure));
  for (int k = 1; k <= 2; ++k) {
    models::RobotBelief received = test::prior(instant(k - 1), sure);
    received.robot = "Q2";
    received.targets[0].last_seen = instant(0);
    take_step(filter, instant(k), at(0, 0), {look_at(sensor, instant(k), at(0, 0), {there_m}, rng)},
              {received});
  }
  EXPECT_EQ(filter.counters().gated, 1);
  EXPECT_LT((known(filter, 0).mean - there_m).norm(), 1.2);
  // Afterwards a more certain belief of a teammate is adopted again.
  models::RobotBelief surer =
      test::prior(instant(2), {{there_m, 0.001 * Eigen::Matrix2d::Identity()}});
  surer.robot = "Q2";
  surer.targets[0].last_seen = instant(0);
  take_step(filter, instant(3), at(0, 0), {}, {surer});
  EXPECT_NEAR(known(filter, 0).covariance(0, 0), 0.001, 1e-6);
}

// A range alone does not locate a target. Detections outside the gate are therefore used; otherwise
// a wrong belief could not be corrected.
TEST(DistributedFilter, DoesNotGateRangesAndBearings) {
  const models::SensorModel sensor = test::far_sighted(SensorKind::kRange);
  std::mt19937_64 rng(12);
  DistributedFilter filter(gated_spec({TargetKind::kStatic, 2, 0.0}, sensor, 1, 4.0));
  filter.rebase(
      test::prior(instant(0), {{Eigen::Vector2d(4.0, 0.0), 0.01 * Eigen::Matrix2d::Identity()}}));
  for (int k = 1; k <= 20; ++k) {
    take_step(filter, instant(k), at(0, 0),
              {look_at(sensor, instant(k), at(0, 0), {Eigen::Vector2d(7.0, 0.0)}, rng)});
  }
  EXPECT_EQ(filter.counters().gated, 0);
  EXPECT_GT(known(filter, 0).mean(0), 6.0);
}

}  // namespace
}  // namespace vantage::estimator
