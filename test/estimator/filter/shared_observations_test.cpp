#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

// Tests that robots that share their observations are as accurate as one filter that receives all
// observations.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace): names for tests

/// Four robots that share observations, and one filter that receives all of them. `hears(k, i, j)`:
/// robot i receives at step k what robot j sent.
struct SharedLooks {
  static constexpr std::size_t kRobots = 4;
  static constexpr int kTargets = 3;

  std::vector<DistributedFilter> robots;
  std::optional<DistributedFilter> central;
  std::vector<Eigen::Vector2d> truth;
  std::vector<models::RobotBelief> beliefs;
  std::vector<std::vector<models::RobotMeasurement>>
      waiting;  ///< observations in transit to a robot
  std::mt19937_64 rng;
  models::SensorModel sensor;

  SharedLooks(SensorKind kind, double range_max_m, unsigned seed)
      : beliefs(kRobots), waiting(kRobots), rng(seed) {
    sensor.kind = kind;
    // Positions are linear, so beliefs can be compared. A bearing needs a minimum range.
    sensor.range_min_m = kind == SensorKind::kPosition ? 0.0 : 0.1;
    FilterSpec spec = open_spec({TargetKind::kRandomWalk, 2, 0.1}, sensor, kTargets);
    sensor.range_max_m = range_max_m;
    spec.sensor = sensor;
    spec.estimator.detection_probability = kind == SensorKind::kPosition ? 0.0 : 0.9;
    spec.communication_range_m = 1e3;
    for (std::size_t i = 0; i < kRobots; ++i) {
      spec.team.push_back({name(i), sensor});
    }
    std::vector<Gaussian> start;
    for (int m = 0; m < kTargets; ++m) {
      truth.emplace_back(2.0 * test::normal_vector(2, rng));
      start.push_back({truth.back() + test::normal_vector(2, rng), Eigen::Matrix2d::Identity()});
    }
    for (std::size_t i = 0; i < kRobots; ++i) {
      spec.robot = name(i);
      robots.emplace_back(spec).rebase(test::prior(instant(0), start));
    }
    spec.robot = name(0);
    central.emplace(spec).rebase(test::prior(instant(0), start));
  }

  static std::string name(std::size_t i) { return "Q" + std::to_string(i); }

  template <class Hears>
  void step(int k, const Hears& hears) {
    for (Eigen::Vector2d& y_m : truth) {
      y_m += std::sqrt(0.1 * 0.5) * test::normal_vector(2, rng);
    }
    std::vector<models::RobotMeasurement> looks;
    std::vector<models::Viewpoint> from;
    for (std::size_t i = 0; i < kRobots; ++i) {
      const double angle_rad = 0.3 * k + 1.6 * static_cast<double>(i);
      from.push_back(at(2.0 * std::cos(angle_rad), 2.0 * std::sin(angle_rad), angle_rad));
      models::RobotMeasurement look = look_at(sensor, instant(k), from[i], truth, rng);
      look.robot = name(i);
      std::erase_if(look.detections, [&](const models::Detection& d) {
        return !models::in_view(sensor, from[i], truth[static_cast<std::size_t>(d.target_id)]);
      });
      looks.push_back(look);
    }
    std::vector<models::RobotBelief> next;
    for (std::size_t i = 0; i < kRobots; ++i) {
      auto [used, received] =
          test::received_by(i, looks, beliefs, [&](std::size_t j) { return hears(k, i, j); });
      std::shuffle(used.begin(), used.end(), rng);
      for (const models::RobotMeasurement& look : std::vector(used)) {
        if (k % 5 == 0 && look.robot != name(i)) {
          used.push_back(look);  // duplicate from another run of the sensor, accepted by the bus
        }
      }
      next.push_back(take_step(robots[i], instant(k), from[i], used, received));
    }
    beliefs = next;
    take_step(*central, instant(k), from[0], looks);
  }

  /// Returns the entropy of robot i's belief about target m minus that of the central filter.
  [[nodiscard]] double entropy_gap_nats(std::size_t i, int m) const {
    return models::entropy_nats(known(robots[i], m)) - models::entropy_nats(known(*central, m));
  }
};

TEST(SharedMeasurements, MakeEveryRobotEqualTheCentralFilter) {
  for (const SensorKind kind : {SensorKind::kPosition, SensorKind::kRangeBearing}) {
    SharedLooks team(kind, 2.5, 3);
    for (int k = 1; k <= 60; ++k) {
      team.step(k, [](int, std::size_t, std::size_t) { return true; });
      for (std::size_t i = 0; i < SharedLooks::kRobots; ++i) {
        for (int m = 0; m < SharedLooks::kTargets; ++m) {
          ASSERT_NEAR(team.entropy_gap_nats(i, m), 0.0, 1e-6) << "robot " << i << " step " << k;
          ASSERT_LT((known(team.robots[i], m).mean - known(*team.central, m).mean).norm(), 1e-6);
        }
      }
    }
    EXPECT_GT(team.robots[1].counters().repeated_looks, 0);
    EXPECT_EQ(team.robots[1].counters().out_of_range_looks, 0);
  }
}

TEST(SharedMeasurements, AreConsistentAndRecoverAfterAPartition) {
  // 30 % of all messages are lost. From step 30 to 60 the team is split into two pairs.
  double least = 1.0;
  double before_nats = 0.0;
  double apart_nats = 0.0;
  double healed_nats = 0.0;
  int judged = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    SharedLooks team(SensorKind::kPosition, 100.0, 50 + seed);
    std::bernoulli_distribution is_lost(0.3);
    for (int k = 1; k <= 80; ++k) {
      team.step(k, [&](int step, std::size_t i, std::size_t j) {
        const bool is_parted = step >= 30 && step < 60 && i / 2 != j / 2;
        return !is_parted && !is_lost(team.rng);
      });
      for (std::size_t i = 0; i < SharedLooks::kRobots; ++i) {
        for (int m = 0; m < SharedLooks::kTargets; ++m) {
          const Eigen::Matrix2d gap = Eigen::Matrix2d(team.central->track(m).information.matrix) -
                                      Eigen::Matrix2d(team.robots[i].track(m).information.matrix);
          least = std::min(least, gap.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff());
          // The three intervals have 17 steps: before the partition, at its end, and from 2 s after
          // it.
          const double gap_nats = team.entropy_gap_nats(i, m);
          before_nats += k >= 13 && k < 30 ? gap_nats : 0.0;
          apart_nats += k >= 43 && k < 60 ? gap_nats : 0.0;
          healed_nats += k >= 64 ? gap_nats : 0.0;
          judged += k >= 64 ? 1 : 0;
        }
      }
    }
  }
  before_nats /= judged;
  apart_nats /= judged;
  healed_nats /= judged;
  RecordProperty("gap_before_nats", std::to_string(before_nats));
  RecordProperty("gap_apart_nats", std::to_string(apart_nats));
  RecordProperty("gap_healed_nats", std::to_string(healed_nats));
  EXPECT_GE(least, -1e-9);
  // Lost observations increase the entropy. The effect of the partition disappears after its end.
  EXPECT_LT(healed_nats, before_nats + 0.06);
  EXPECT_GT(apart_nats, before_nats + 0.1);
}

TEST(SharedMeasurements, GiveTheSameBeliefWhenTheyArriveLate) {
  // The belief of step k contains the observation of step k; the observation itself arrives two
  // steps later.
  models::SensorModel sensor = test::far_sighted(SensorKind::kPosition);
  FilterSpec spec = open_spec({TargetKind::kRandomWalk, 2, 0.1}, sensor, 1);
  spec.communication_range_m = 1e3;
  spec.team = {{"Q1", sensor}, {"Q2", sensor}};
  const std::vector<Gaussian> start = {{Eigen::Vector2d(1.0, 1.0), Eigen::Matrix2d::Identity()}};
  std::mt19937_64 rng(6);
  FilterSpec other = spec;
  other.robot = "Q2";
  DistributedFilter timely(spec);
  DistributedFilter late(spec);
  DistributedFilter maker(other);
  DistributedFilter central(spec);
  for (DistributedFilter* filter : {&timely, &late, &maker, &central}) {
    filter->rebase(test::prior(instant(0), start));
  }
  std::vector<models::RobotMeasurement> held;
  for (int k = 1; k <= 12; ++k) {
    models::RobotMeasurement look =
        look_at(sensor, instant(k), at(0, 0), {Eigen::Vector2d(1.2, 0.8)}, rng);
    look.robot = "Q2";
    held.push_back(look);
    const auto made = take_step(maker, instant(k), at(0, 0), {look});
    take_step(timely, instant(k), at(0, 0), {look}, {made});
    take_step(central, instant(k), at(0, 0), {look});
    const bool is_due = k > 2;
    take_step(late, instant(k), at(0, 0),
              is_due ? std::vector{held[static_cast<std::size_t>(k - 3)]}
                     : std::vector<models::RobotMeasurement>{},
              {made});
    // Neither filter is more certain than a filter that received each observation once.
    for (const DistributedFilter* filter : {&timely, &late}) {
      EXPECT_LE(filter->track(0).information.matrix(0, 0),
                central.track(0).information.matrix(0, 0) * (1.0 + 1e-9));
    }
    EXPECT_TRUE(vantage::test::is_near(known(late, 0).mean, known(timely, 0).mean, 1e-6));
  }
  EXPECT_EQ(late.counters().late_measurements, 10);
}

TEST(SharedMeasurements, AreIgnoredFromTeammatesOutOfRange) {
  SharedLooks team(SensorKind::kPosition, 100.0, 1);
  FilterSpec spec = team.robots[0].spec();
  spec.communication_range_m = 1.0;
  DistributedFilter filter(spec);
  models::RobotMeasurement look =
      look_at(team.sensor, instant(1), at(5, 0), {Eigen::Vector2d(1.0, 1.0)}, team.rng);
  look.robot = "Q1";
  EXPECT_TRUE(take_step(filter, instant(1), at(0, 0), {look}).targets.empty());
  EXPECT_EQ(filter.counters().out_of_range_looks, 1);
  look.stamp.time = instant(2);
  EXPECT_EQ(take_step(filter, instant(2), at(4.5, 0), {look}).targets.size(), 1U);
}

}  // namespace
}  // namespace vantage::estimator
