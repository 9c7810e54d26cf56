#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

// Tests several robots: fusion converges and never counts information twice.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace): names for tests

/// Filters that receive each other's beliefs of the previous step, as on the bus.
class Team {
 public:
  Team(const models::TargetModel& model, const std::vector<models::SensorModel>& sensors,
       int target_count, double communication_range_m) {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      FilterSpec spec = open_spec(model, sensors[i], target_count);
      spec.robot = "Q" + std::to_string(i);
      spec.communication_range_m = communication_range_m;
      filters_.emplace_back(spec);
    }
    beliefs_.resize(sensors.size());
  }

  void start(const std::vector<Gaussian>& targets) {
    for (DistributedFilter& filter : filters_) {
      filter.rebase(test::prior(instant(0), targets));
    }
  }

  /// Makes one step of all robots; `looks[i]` is what robot i observed from `from[i]`.
  void step(int k, const std::vector<models::Viewpoint>& from,
            const std::vector<models::RobotMeasurement>& looks) {
    std::vector<models::RobotBelief> next;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
      next.push_back(take_step(filters_[i], instant(k), from[i], {looks[i]}, received_by(i)));
    }
    beliefs_ = next;
  }

  [[nodiscard]] std::vector<models::RobotBelief> received_by(std::size_t i) const {
    std::vector<models::RobotBelief> received;
    for (std::size_t j = 0; j < filters_.size(); ++j) {
      if (j != i && !beliefs_[j].robot.empty()) {
        received.push_back(beliefs_[j]);
      }
    }
    return received;
  }

  [[nodiscard]] const DistributedFilter& filter(std::size_t i) const { return filters_[i]; }

 private:
  std::vector<DistributedFilter> filters_;
  std::vector<models::RobotBelief> beliefs_;
};

TEST(Team, ConvergesOnAConnectedGraph) {
  // Source: dissertation, theorem 9. The robots form a pentagon with sides within radio range and
  // diagonals beyond it. Robots 0 and 2 measure ranges to all targets, robot 1 bearings to all
  // targets, and robot 3 the position of target 0. Robot 4 measures nothing.
  constexpr int kTargets = 3;
  const std::vector<models::SensorModel> sensors = {
      test::far_sighted(SensorKind::kRange), test::far_sighted(SensorKind::kBearing),
      test::far_sighted(SensorKind::kRange), test::far_sighted(SensorKind::kPosition),
      test::far_sighted(SensorKind::kPosition)};
  std::vector<models::Viewpoint> from;
  for (int i = 0; i < 5; ++i) {
    from.push_back(at(8.0 * std::cos(radians(72.0 * i)), 8.0 * std::sin(radians(72.0 * i))));
  }
  const std::vector<int> checkpoints = {10, 100, 1000};
  std::vector<double> worst_mse_m2(checkpoints.size(), 0.0);
  constexpr unsigned kSeeds = 20;
  std::vector<std::vector<double>> sum(5, std::vector<double>(checkpoints.size(), 0.0));
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 rng(300 + seed);
    std::vector<Eigen::Vector2d> truth = {{1.0, 1.5}, {-2.0, 0.5}, {0.5, -2.5}};
    std::vector<Gaussian> start;
    for (const Eigen::Vector2d& y_m : truth) {
      start.push_back(
          {y_m + 0.7 * test::normal_vector(2, rng), 0.49 * Eigen::Matrix2d::Identity()});
    }
    Team team({TargetKind::kStatic, 2, 0.0}, sensors, kTargets, 10.0);
    team.start(start);
    std::size_t next = 0;
    for (int k = 1; k <= checkpoints.back(); ++k) {
      std::vector<models::RobotMeasurement> looks;
      for (std::size_t i = 0; i < 5; ++i) {
        looks.push_back(look_at(sensors[i], instant(k), from[i], truth, rng));
      }
      looks[3].detections.resize(1);
      looks[4].detections.clear();
      team.step(k, from, looks);
      if (k == checkpoints[next]) {
        for (std::size_t i = 0; i < 5; ++i) {
          for (int m = 0; m < kTargets; ++m) {
            const Eigen::Vector2d error =
                known(team.filter(i), m).mean - truth[static_cast<std::size_t>(m)];
            sum[i][next] += error.squaredNorm() / (kSeeds * kTargets);
          }
        }
        ++next;
      }
    }
  }
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t c = 0; c < checkpoints.size(); ++c) {
      worst_mse_m2[c] = std::max(worst_mse_m2[c], sum[i][c]);
    }
  }
  // The mean square error falls as 1/k: ten times the observations give about a tenth of the error
  // for every robot.
  EXPECT_LT(worst_mse_m2[1], worst_mse_m2[0] / 3.0);
  EXPECT_LT(worst_mse_m2[2], worst_mse_m2[1] / 5.0);
  EXPECT_LT(worst_mse_m2[2], 0.02 * 0.02);
  RecordProperty("mse_m2_at_1000", std::to_string(worst_mse_m2[2]));
}

TEST(Team, IsNeverMoreCertainThanTheCentralFilter) {
  constexpr int kTargets = 2;
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.05};
  const std::vector<models::SensorModel> sensors(4, test::far_sighted(SensorKind::kRangeBearing));
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937_64 rng(70 + seed);
    std::uniform_real_distribution<double> place(-10.0, 10.0);
    std::bernoulli_distribution sees(0.5);
    const std::vector<Eigen::Vector2d> truth = {{1.0, 2.0}, {-3.0, -1.0}};
    const std::vector<Gaussian> start = {{truth[0], Eigen::Matrix2d::Identity()},
                                         {truth[1], Eigen::Matrix2d::Identity()}};
    Team team(model, sensors, kTargets, 8.0);
    team.start(start);
    std::vector<Eigen::Matrix2d> central(kTargets, Eigen::Matrix2d::Identity());  // Ω by target
    double least = 1.0;
    for (int k = 1; k <= 200; ++k) {
      std::vector<models::Viewpoint> from;
      std::vector<models::RobotMeasurement> looks;
      for (Eigen::Matrix2d& omega : central) {
        omega = (omega.inverse() + 0.05 * 0.5 * Eigen::Matrix2d::Identity()).inverse().eval();
      }
      for (std::size_t i = 0; i < 4; ++i) {
        from.push_back(at(place(rng), place(rng), 0.1 * k));
        looks.push_back(look_at(sensors[i], instant(k), from[i], truth, rng));
        std::erase_if(looks[i].detections, [&](const auto&) { return !sees(rng); });
        // The information gain of an observation is the difference from a step of robot i without
        // an observation.
        DistributedFilter blind = team.filter(i);
        take_step(blind, instant(k), from[i], {}, team.received_by(i));
        for (const models::Detection& d : looks[i].detections) {
          const models::Information before = blind.track(d.target_id).information;
          models::Information after = before;
          ASSERT_EQ(measure(after, sensors[i], from[i], d.measurement, 0.0), Use::kUsed);
          central[static_cast<std::size_t>(d.target_id)] += after.matrix - before.matrix;
        }
      }
      team.step(k, from, looks);
      for (std::size_t i = 0; i < 4; ++i) {
        for (int m = 0; m < kTargets; ++m) {
          const Eigen::Matrix2d gap = central[static_cast<std::size_t>(m)] -
                                      Eigen::Matrix2d(team.filter(i).track(m).information.matrix);
          least = std::min(least, gap.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff());
        }
      }
    }
    EXPECT_GE(least, -1e-9) << "seed " << seed;
  }
}

TEST(Team, IsConsistent) {
  constexpr int kTargets = 3;
  constexpr std::size_t kRobots = 4;
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.02};
  const std::vector<models::SensorModel> sensors(kRobots, test::far_sighted(SensorKind::kPosition));
  std::vector<double> nees(kRobots, 0.0);
  for (unsigned run = 0; run < 100; ++run) {
    std::mt19937_64 rng(5000 + run);
    std::bernoulli_distribution sees(0.6);
    std::vector<Eigen::Vector2d> truth;
    std::vector<Gaussian> start;
    for (int m = 0; m < kTargets; ++m) {
      truth.emplace_back(3.0 * test::normal_vector(2, rng));
      start.push_back({truth.back() + test::normal_vector(2, rng), Eigen::Matrix2d::Identity()});
    }
    Team team(model, sensors, kTargets, 100.0);
    team.start(start);
    const std::vector<models::Viewpoint> from = {at(0, 0), at(5, 0, 1), at(0, 5, 2), at(5, 5, 3)};
    for (int k = 1; k <= 30; ++k) {
      for (Eigen::Vector2d& y_m : truth) {
        y_m += std::sqrt(0.02 * 0.5) * test::normal_vector(2, rng);
      }
      std::vector<models::RobotMeasurement> looks;
      for (std::size_t i = 0; i < kRobots; ++i) {
        looks.push_back(look_at(sensors[i], instant(k), from[i], truth, rng));
        std::erase_if(looks[i].detections, [&](const auto&) { return !sees(rng); });
      }
      team.step(k, from, looks);
    }
    for (std::size_t i = 0; i < kRobots; ++i) {
      for (int m = 0; m < kTargets; ++m) {
        const Gaussian g = known(team.filter(i), m);
        const Eigen::Vector2d error = g.mean - truth[static_cast<std::size_t>(m)];
        nees[i] += error.dot(Eigen::Matrix2d(g.covariance).inverse() * error);
      }
    }
  }
  for (const double robot_nees : nees) {
    EXPECT_LE(robot_nees, test::chi2_quantile(100.0 * kTargets * 2.0, 1.645));
  }
}

/// A robot without any track, and a teammate with a track of target 0.
class Newcomer : public ::testing::Test {
 protected:
  Newcomer() {
    teammate_ =
        test::prior(instant(9), {{Eigen::Vector2d(3.0, 4.0), 0.5 * Eigen::Matrix2d::Identity()}});
    teammate_.robot = "Q2";
    teammate_.degree = 1;
    teammate_.viewpoint = at(6.0, 0.0);
  }
  DistributedFilter filter(double communication_range_m) {
    FilterSpec spec =
        open_spec({TargetKind::kRandomWalk, 2, 0.1}, test::far_sighted(SensorKind::kRange), 2);
    spec.communication_range_m = communication_range_m;
    return DistributedFilter(spec);
  }
  models::RobotBelief teammate_;
};

TEST_F(Newcomer, AdoptsATeammatesBeliefPredictedToThePresent) {
  DistributedFilter newcomer = filter(6.5);
  const auto belief = take_step(newcomer, instant(10), at(0, 0), {}, {teammate_});
  ASSERT_EQ(belief.targets.size(), 1u);
  EXPECT_EQ(belief.degree, 1);
  EXPECT_EQ(belief.targets[0].last_seen, instant(9));
  const Gaussian g = known(newcomer, 0);
  EXPECT_TRUE(vantage::test::is_near(g.mean, Eigen::Vector2d(3.0, 4.0), 1e-12));
  EXPECT_TRUE(vantage::test::is_near(g.covariance, 0.55 * Eigen::Matrix2d::Identity(), 1e-12));
}

TEST_F(Newcomer, AdoptsTheDominatingBelief) {
  DistributedFilter newcomer = filter(6.5);
  newcomer.rebase(
      test::prior(instant(9), {{Eigen::Vector2d(1.0, 0.0), 0.95 * Eigen::Matrix2d::Identity()}}));
  take_step(newcomer, instant(10), at(0, 0), {}, {teammate_});
  EXPECT_TRUE(vantage::test::is_near(known(newcomer, 0).mean, Eigen::Vector2d(3.0, 4.0), 1e-9));
  EXPECT_NEAR(newcomer.track(0).information.matrix(0, 0), 1.0 / 0.55, 1e-9);

  DistributedFilter expert = filter(6.5);
  expert.rebase(
      test::prior(instant(9), {{Eigen::Vector2d(1.0, 0.0), 0.15 * Eigen::Matrix2d::Identity()}}));
  take_step(expert, instant(10), at(0, 0), {}, {teammate_});
  EXPECT_TRUE(vantage::test::is_near(known(expert, 0).mean, Eigen::Vector2d(1.0, 0.0), 1e-9));
  EXPECT_NEAR(expert.track(0).information.matrix(0, 0), 1.0 / 0.2, 1e-9);
}

// The adopted time is the later of the two observation times.
TEST_F(Newcomer, AdoptsTheTimeOfTheLastObservation) {
  for (const int own : {5, 10}) {
    DistributedFilter newcomer = filter(6.5);
    newcomer.rebase(test::prior(instant(own),
                                {{Eigen::Vector2d(1.0, 0.0), 0.95 * Eigen::Matrix2d::Identity()}}));
    const auto belief = take_step(newcomer, instant(10) + Duration{1}, at(0, 0), {}, {teammate_});
    ASSERT_EQ(belief.targets.size(), 1u);
    EXPECT_EQ(belief.targets[0].last_seen, instant(std::max(own, 9)));
  }
}

TEST_F(Newcomer, FusesComplementaryBeliefsByCovarianceIntersection) {
  DistributedFilter newcomer = filter(6.5);
  const Eigen::Matrix2d wide_in_x = Eigen::Vector2d(2.0, 0.5).asDiagonal();
  const Eigen::Matrix2d wide_in_y = Eigen::Vector2d(0.5, 2.0).asDiagonal();
  newcomer.rebase(test::prior(instant(10), {{Eigen::Vector2d(1.0, 0.0), wide_in_x}}));
  models::RobotBelief other = test::prior(instant(10), {{Eigen::Vector2d(3.0, 4.0), wide_in_y}});
  other.robot = "Q2";
  other.stamp.time = instant(10);
  take_step(newcomer, instant(10) + Duration{1}, at(0, 0), {}, {other});
  // The beliefs are mirror images, so κ = ½ and Ω = ½ (½ + 2) I. Each coordinate is closer to the
  // more certain belief.
  const Gaussian g = known(newcomer, 0);
  EXPECT_TRUE(vantage::test::is_near(g.covariance, 0.8 * Eigen::Matrix2d::Identity(), 1e-3));
  EXPECT_TRUE(vantage::test::is_near(g.mean, Eigen::Vector2d(2.6, 0.8), 1e-2));
}

TEST_F(Newcomer, IgnoresATeammateWithoutInformation) {
  DistributedFilter newcomer = filter(10.0);
  newcomer.rebase(
      test::prior(instant(9), {{Eigen::Vector2d(1.0, 0.0), 0.95 * Eigen::Matrix2d::Identity()}}));
  models::RobotBelief ignorant = test::prior(instant(9), {});
  ignorant.robot = "Q3";
  take_step(newcomer, instant(10), at(0, 0), {}, {teammate_, ignorant});
  EXPECT_NEAR(newcomer.track(0).information.matrix(0, 0), 1.0 / 0.55, 1e-9);
}

TEST_F(Newcomer, ReceivesNothingBeyondTheRadioRange) {
  DistributedFilter newcomer = filter(5.9);
  EXPECT_TRUE(take_step(newcomer, instant(10), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().out_of_range_beliefs, 1);
}

TEST_F(Newcomer, ReceivesNothingWithoutARadio) {
  DistributedFilter newcomer = filter(0.0);
  teammate_.viewpoint = at(0, 0);
  EXPECT_TRUE(take_step(newcomer, instant(10), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().out_of_range_beliefs, 1);
}

TEST_F(Newcomer, RefusesOldAndFutureBeliefs) {
  DistributedFilter newcomer = filter(10.0);
  EXPECT_TRUE(take_step(newcomer, instant(8), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_TRUE(take_step(newcomer, instant(13), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().future_beliefs, 1);
  EXPECT_EQ(newcomer.counters().stale_beliefs, 1);
}

TEST_F(Newcomer, AdoptsATeammatesObservedCells) {
  DistributedFilter newcomer = filter(10.0);
  teammate_.grid = newcomer.grid().geometry();
  teammate_.last_seen_utime.assign(static_cast<std::size_t>(teammate_.grid.size()), 0);
  teammate_.last_seen_utime[3] = to_utime(instant(7));
  teammate_.last_seen_utime[4] = to_utime(instant(99));  // a time in the future is ignored
  const auto belief = take_step(newcomer, instant(10), at(0, 0), {}, {teammate_});
  EXPECT_EQ(belief.last_seen_utime[3], to_utime(instant(7)));
  EXPECT_EQ(belief.last_seen_utime[4], to_utime(instant(9)));
  teammate_.grid.columns += 1;
  take_step(newcomer, instant(11), at(0, 0), {}, {teammate_});
  EXPECT_EQ(newcomer.counters().grid_mismatches, 1);
}

}  // namespace
}  // namespace vantage::estimator
