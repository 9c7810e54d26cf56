#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "estimator/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"

// Several robots: what is exchanged is fused without ever being counted twice, and converges.

namespace vantage::estimator {
namespace {

using models::Gaussian;
using models::SensorKind;
using models::TargetKind;
using test::at;
using test::instant;
using test::known;
using test::look_at;
using test::open_spec;
using test::take_step;

/// Filters that hear each other's beliefs of the step before, the way they travel on the bus.
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

  /// One step of everyone; `looks[i]` is what robot i saw from `from[i]`.
  void step(int k, const std::vector<models::Viewpoint>& from,
            const std::vector<models::DetectionSet>& looks) {
    std::vector<models::RobotBelief> next;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
      next.push_back(take_step(filters_[i], instant(k), from[i], {looks[i]}, heard_by(i)));
    }
    beliefs_ = next;
  }

  [[nodiscard]] std::vector<models::RobotBelief> heard_by(std::size_t i) const {
    std::vector<models::RobotBelief> heard;
    for (std::size_t j = 0; j < filters_.size(); ++j) {
      if (j != i && !beliefs_[j].robot.empty()) {
        heard.push_back(beliefs_[j]);
      }
    }
    return heard;
  }

  [[nodiscard]] const DistributedFilter& filter(std::size_t i) const { return filters_[i]; }

 private:
  std::vector<DistributedFilter> filters_;
  std::vector<models::RobotBelief> beliefs_;
};

models::SensorModel far_sighted(SensorKind kind) {
  models::SensorModel sensor;
  sensor.kind = kind;
  sensor.range_max_m = 1e4;
  return sensor;
}

TEST(Team, OnAConnectedGraphConvergesToStaticTargetsThatNobodyCouldFindAlone) {
  // Theorem 9. A pentagon whose sides, not its diagonals, are within radio range. Robots 0 and 2
  // measure ranges of all, 1 bearings of all, 3 the position of target 0 only, 4 sees nothing.
  constexpr int kTargets = 3;
  const std::vector<models::SensorModel> sensors = {
      far_sighted(SensorKind::kRange), far_sighted(SensorKind::kBearing),
      far_sighted(SensorKind::kRange), far_sighted(SensorKind::kPosition),
      far_sighted(SensorKind::kPosition)};
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
      std::vector<models::DetectionSet> looks;
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
  // The mean square falls like 1/k: tenfold the looks, about a tenth of it, for every robot.
  EXPECT_LT(worst_mse_m2[1], worst_mse_m2[0] / 3.0);
  EXPECT_LT(worst_mse_m2[2], worst_mse_m2[1] / 5.0);
  EXPECT_LT(worst_mse_m2[2], 0.02 * 0.02);
  RecordProperty("mse_m2_at_1000", std::to_string(worst_mse_m2[2]));
}

TEST(Team, IsNeverMoreCertainThanTheCentralFilter) {
  constexpr int kTargets = 2;
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.05};
  const std::vector<models::SensorModel> sensors(4, far_sighted(SensorKind::kRangeBearing));
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937_64 rng(70 + seed);
    std::uniform_real_distribution<double> place(-10.0, 10.0);
    std::bernoulli_distribution sees(0.5);
    const std::vector<Eigen::Vector2d> truth = {{1.0, 2.0}, {-3.0, -1.0}};
    const std::vector<Gaussian> start = {{truth[0], Eigen::Matrix2d::Identity()},
                                         {truth[1], Eigen::Matrix2d::Identity()}};
    Team team(model, sensors, kTargets, 8.0);
    team.start(start);
    std::vector<Eigen::Matrix2d> central(kTargets, Eigen::Matrix2d::Identity());  // Ω
    double least = 1.0;
    for (int k = 1; k <= 200; ++k) {
      std::vector<models::Viewpoint> from;
      std::vector<models::DetectionSet> looks;
      for (Eigen::Matrix2d& omega : central) {
        omega = (omega.inverse() + 0.05 * 0.5 * Eigen::Matrix2d::Identity()).inverse().eval();
      }
      for (std::size_t i = 0; i < 4; ++i) {
        from.push_back(at(place(rng), place(rng), 0.1 * k));
        looks.push_back(look_at(sensors[i], instant(k), from[i], truth, rng));
        std::erase_if(looks[i].detections, [&](const auto&) { return !sees(rng); });
        // What the look adds: to robot i's own step without it.
        DistributedFilter blind = team.filter(i);
        take_step(blind, instant(k), from[i], {}, team.heard_by(i));
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

TEST(Team, IsNotOverconfident) {
  constexpr int kTargets = 3;
  constexpr std::size_t kRobots = 4;
  const models::TargetModel model{TargetKind::kRandomWalk, 2, 0.02};
  const std::vector<models::SensorModel> sensors(kRobots, far_sighted(SensorKind::kPosition));
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
      std::vector<models::DetectionSet> looks;
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

/// A robot that knows nothing, and a teammate who knows target 0.
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
        open_spec({TargetKind::kRandomWalk, 2, 0.1}, far_sighted(SensorKind::kRange), 2);
    spec.communication_range_m = communication_range_m;
    return DistributedFilter(spec);
  }
  models::RobotBelief teammate_;
};

TEST_F(Newcomer, TakesATeammatesBeliefWholeAndBringsItToItsOwnTime) {
  DistributedFilter newcomer = filter(6.5);
  const auto belief = take_step(newcomer, instant(10), at(0, 0), {}, {teammate_});
  ASSERT_EQ(belief.targets.size(), 1u);
  EXPECT_EQ(belief.degree, 1);
  EXPECT_EQ(belief.targets[0].last_seen, instant(9));
  const Gaussian g = known(newcomer, 0);
  EXPECT_TRUE(vantage::test::is_near(g.mean, Eigen::Vector2d(3.0, 4.0), 1e-12));
  EXPECT_TRUE(vantage::test::is_near(g.covariance, 0.55 * Eigen::Matrix2d::Identity(), 1e-12));
}

TEST_F(Newcomer, TakesTheSurerBeliefWhereOneHoldsMoreInEveryDirection) {
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

TEST_F(Newcomer, IntersectsBeliefsThatEachHoldSomethingTheOtherDoesNot) {
  DistributedFilter newcomer = filter(6.5);
  const Eigen::Matrix2d wide_in_x = Eigen::Vector2d(2.0, 0.5).asDiagonal();
  const Eigen::Matrix2d wide_in_y = Eigen::Vector2d(0.5, 2.0).asDiagonal();
  newcomer.rebase(test::prior(instant(10), {{Eigen::Vector2d(1.0, 0.0), wide_in_x}}));
  models::RobotBelief other = test::prior(instant(10), {{Eigen::Vector2d(3.0, 4.0), wide_in_y}});
  other.robot = "Q2";
  other.stamp.time = instant(10);
  take_step(newcomer, instant(10) + Duration{1}, at(0, 0), {}, {other});
  // Mirror images: κ = ½, so Ω = ½ (½ + 2) I; each coordinate is nearer to who knows it.
  const Gaussian g = known(newcomer, 0);
  EXPECT_TRUE(vantage::test::is_near(g.covariance, 0.8 * Eigen::Matrix2d::Identity(), 1e-3));
  EXPECT_TRUE(vantage::test::is_near(g.mean, Eigen::Vector2d(2.6, 0.8), 1e-2));
}

TEST_F(Newcomer, IsNotMadeLessCertainByATeammateWhoDoesNotKnowTheTarget) {
  DistributedFilter newcomer = filter(10.0);
  newcomer.rebase(
      test::prior(instant(9), {{Eigen::Vector2d(1.0, 0.0), 0.95 * Eigen::Matrix2d::Identity()}}));
  models::RobotBelief ignorant = test::prior(instant(9), {});
  ignorant.robot = "Q3";
  take_step(newcomer, instant(10), at(0, 0), {}, {teammate_, ignorant});
  EXPECT_NEAR(newcomer.track(0).information.matrix(0, 0), 1.0 / 0.55, 1e-9);
}

TEST_F(Newcomer, HearsNobodyBeyondTheRadioRange) {
  DistributedFilter newcomer = filter(5.9);
  EXPECT_TRUE(take_step(newcomer, instant(10), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().out_of_range_beliefs, 1);
}

TEST_F(Newcomer, HearsNobodyWithoutARadio) {
  DistributedFilter newcomer = filter(0.0);
  teammate_.viewpoint = at(0, 0);
  EXPECT_TRUE(take_step(newcomer, instant(10), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().out_of_range_beliefs, 1);
}

TEST_F(Newcomer, RefusesOldNewsAndNewsOfTheFuture) {
  DistributedFilter newcomer = filter(10.0);
  EXPECT_TRUE(take_step(newcomer, instant(8), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_TRUE(take_step(newcomer, instant(13), at(0, 0), {}, {teammate_}).targets.empty());
  EXPECT_EQ(newcomer.counters().future_beliefs, 1);
  EXPECT_EQ(newcomer.counters().stale_beliefs, 1);
}

TEST_F(Newcomer, TakesOverWhatTheTeammateHasSeenOfTheGround) {
  DistributedFilter newcomer = filter(10.0);
  teammate_.grid = newcomer.grid().geometry();
  teammate_.last_seen_utime.assign(static_cast<std::size_t>(teammate_.grid.size()), 0);
  teammate_.last_seen_utime[3] = to_utime(instant(7));
  teammate_.last_seen_utime[4] = to_utime(instant(99));  // nobody has seen the future
  const auto belief = take_step(newcomer, instant(10), at(0, 0), {}, {teammate_});
  EXPECT_EQ(belief.last_seen_utime[3], to_utime(instant(7)));
  EXPECT_EQ(belief.last_seen_utime[4], to_utime(instant(9)));
  teammate_.grid.columns += 1;
  take_step(newcomer, instant(11), at(0, 0), {}, {teammate_});
  EXPECT_EQ(newcomer.counters().grid_mismatches, 1);
}

/// Four robots whose looks are shared, beside one filter that has all of them. `hears(k, i, j)`:
/// robot i has at step k what j sent.
struct SharedLooks {
  static constexpr std::size_t kRobots = 4;
  static constexpr int kTargets = 3;

  std::vector<DistributedFilter> robots;
  std::optional<DistributedFilter> central;
  std::vector<Eigen::Vector2d> truth;
  std::vector<models::RobotBelief> beliefs;
  std::vector<std::vector<models::DetectionSet>> waiting;  ///< looks on their way to a robot
  std::mt19937_64 rng;
  models::SensorModel sensor;

  SharedLooks(SensorKind kind, double range_max_m, unsigned seed)
      : beliefs(kRobots), waiting(kRobots), rng(seed) {
    sensor.kind = kind;
    // Positions are linear everywhere, so that beliefs can be ordered; with a bearing there is a
    // least range.
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
    std::vector<models::DetectionSet> looks;
    std::vector<models::Viewpoint> from;
    for (std::size_t i = 0; i < kRobots; ++i) {
      const double angle_rad = 0.3 * k + 1.6 * static_cast<double>(i);
      from.push_back(at(2.0 * std::cos(angle_rad), 2.0 * std::sin(angle_rad), angle_rad));
      models::DetectionSet look = look_at(sensor, instant(k), from[i], truth, rng);
      look.robot = name(i);
      std::erase_if(look.detections, [&](const models::Detection& d) {
        return !models::in_view(sensor, from[i], truth[static_cast<std::size_t>(d.target_id)]);
      });
      looks.push_back(look);
    }
    std::vector<models::RobotBelief> next;
    for (std::size_t i = 0; i < kRobots; ++i) {
      std::vector<models::DetectionSet> used;
      std::vector<models::RobotBelief> heard;
      for (std::size_t j = 0; j < kRobots; ++j) {
        if (i == j || hears(k, i, j)) {
          used.push_back(looks[j]);
        }
        if (i != j && hears(k, i, j) && !beliefs[j].robot.empty()) {
          heard.push_back(beliefs[j]);
        }
      }
      std::shuffle(used.begin(), used.end(), rng);
      for (const models::DetectionSet& look : std::vector(used)) {
        if (k % 5 == 0 && look.robot != name(i)) {
          used.push_back(look);  // from another run of its sensor, which the bus takes for new
        }
      }
      next.push_back(take_step(robots[i], instant(k), from[i], used, heard));
    }
    beliefs = next;
    take_step(*central, instant(k), from[0], looks);
  }

  /// Of robot i's belief about target m over the central one's.
  [[nodiscard]] double entropy_gap_nats(std::size_t i, int m) const {
    return models::entropy_nats(known(robots[i], m)) - models::entropy_nats(known(*central, m));
  }
};

TEST(SharedLooks, MakeEveryRobotTheCentralFilterWhereAllHearAll) {
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

TEST(SharedLooks, NeverMakeARobotSurerThanTheCentralFilterAndRecoverWhenAPartitionHeals) {
  // 30 % of everything is lost; from step 30 to 60 two and two do not hear each other.
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
          // 17 steps each: before, the end of the partition, and from 2 s after it on.
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
  // Lost looks cost what they cost, and the partition nothing more once it is over.
  EXPECT_LT(healed_nats, before_nats + 0.06);
  EXPECT_GT(apart_nats, before_nats + 0.1);
}

TEST(SharedLooks, ThatComeLateGiveTheBeliefOfTimelyOnesThoughTheirMakersBeliefCameFirst) {
  // The belief of step k holds the look of step k; the look itself arrives two steps later.
  models::SensorModel sensor = far_sighted(SensorKind::kPosition);
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
  std::vector<models::DetectionSet> held;
  for (int k = 1; k <= 12; ++k) {
    models::DetectionSet look =
        look_at(sensor, instant(k), at(0, 0), {Eigen::Vector2d(1.2, 0.8)}, rng);
    look.robot = "Q2";
    held.push_back(look);
    const auto made = take_step(maker, instant(k), at(0, 0), {look});
    take_step(timely, instant(k), at(0, 0), {look}, {made});
    take_step(central, instant(k), at(0, 0), {look});
    const bool is_due = k > 2;
    take_step(late, instant(k), at(0, 0),
              is_due ? std::vector{held[static_cast<std::size_t>(k - 3)]}
                     : std::vector<models::DetectionSet>{},
              {made});
    // Neither is surer than who was told of each look once.
    for (const DistributedFilter* filter : {&timely, &late}) {
      EXPECT_LE(filter->track(0).information.matrix(0, 0),
                central.track(0).information.matrix(0, 0) * (1.0 + 1e-9));
    }
    EXPECT_TRUE(vantage::test::is_near(known(late, 0).mean, known(timely, 0).mean, 1e-6));
  }
  EXPECT_EQ(late.counters().late_measurements, 10);
}

TEST(SharedLooks, OfTeammatesOutOfRangeAreLeft) {
  SharedLooks team(SensorKind::kPosition, 100.0, 1);
  FilterSpec spec = team.robots[0].spec();
  spec.communication_range_m = 1.0;
  DistributedFilter filter(spec);
  models::DetectionSet look =
      look_at(team.sensor, instant(1), at(5, 0), {Eigen::Vector2d(1.0, 1.0)}, team.rng);
  look.robot = "Q1";
  EXPECT_TRUE(take_step(filter, instant(1), at(0, 0), {look}).targets.empty());
  EXPECT_EQ(filter.counters().out_of_range_looks, 1);
  look.stamp.time = instant(2);
  EXPECT_EQ(take_step(filter, instant(2), at(4.5, 0), {look}).targets.size(), 1U);
}

}  // namespace
}  // namespace vantage::estimator
