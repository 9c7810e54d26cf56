#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "estimator/tracks/labelled/mixture.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "models/sensor/clutter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/allocation_counter.hpp"
#include "test/support/near.hpp"

// Tests of teams with sensors that report no ids: labels of tracks, and observations that are lost,
// late or received twice.

namespace vantage::estimator {
namespace {

using test::at;
using test::instant;
using test::take_step;
using vantage::test::is_near;

constexpr std::size_t kRobots = 3;
constexpr int kTargets = 4;

std::string robot_name(std::size_t i) { return "Q" + std::to_string(i + 1); }

FilterSpec spec_of(std::size_t robot) {
  models::SensorModel sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 3.0;
  sensor.range_sigma_m = 0.1;
  FilterSpec spec;
  spec.robot = robot_name(robot);
  spec.sensor = sensor;
  spec.detection = {0.9, 1.0, false};
  for (std::size_t i = 0; i < kRobots; ++i) {
    spec.team.push_back({robot_name(i), sensor, spec.detection});
  }
  spec.estimator.target_model = {models::TargetKind::kRandomWalk, 2, 0.02};
  spec.estimator.grid_resolution_m = 1.0;
  spec.estimator.targets_stay_inside = false;
  spec.world.bounds = {{-4.0, -4.0}, {4.0, 4.0}};
  spec.target_count = kTargets;
  spec.communication_range_m = 1e3;
  return spec;
}

/// Simulated detections of all robots at each step.
class Scene {
 public:
  explicit Scene(unsigned seed) : rng_(seed) {}

  std::vector<models::RobotMeasurement> looks(int k) {
    for (Eigen::Vector2d& y_m : targets_m_) {
      y_m += std::sqrt(0.02 * 0.5) * test::normal_vector(2, rng_);
      y_m = y_m.cwiseMax(-3.5).cwiseMin(3.5);
    }
    std::vector<models::RobotMeasurement> out;
    for (std::size_t i = 0; i < kRobots; ++i) {
      out.push_back(look(k, i));
    }
    return out;
  }
  static models::Viewpoint place(int k, std::size_t robot) {
    const double angle_rad = 0.15 * k + 2.0 * kPi / 3.0 * static_cast<double>(robot);
    return at(2.0 * std::cos(angle_rad), 2.0 * std::sin(angle_rad), angle_rad);
  }
  std::mt19937_64& rng() { return rng_; }

 private:
  models::RobotMeasurement look(int k, std::size_t robot) {
    const FilterSpec spec = spec_of(robot);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    models::RobotMeasurement seen;
    seen.stamp.time = instant(k);
    seen.robot = spec.robot;
    seen.viewpoint = place(k, robot);
    for (const Eigen::Vector2d& y_m : targets_m_) {
      if (models::in_view(spec.sensor, seen.viewpoint, y_m) &&
          share(rng_) < spec.detection.detection_probability) {
        seen.detections.push_back(
            {models::kNoTargetId, models::sample(spec.sensor, seen.viewpoint, y_m, rng_)});
      }
    }
    for (const models::Measurement& z : models::sample_clutter(
             spec.sensor, seen.viewpoint, spec.detection.clutter_per_look, rng_)) {
      seen.detections.push_back({models::kNoTargetId, z});
    }
    return seen;
  }

  std::mt19937_64 rng_;
  std::array<Eigen::Vector2d, kTargets> targets_m_ = {
      Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(-1.5, 1.0), Eigen::Vector2d(0.5, -2.0),
      Eigen::Vector2d(2.5, 0.0)};
};

std::vector<int> labels_of(const models::RobotBelief& belief) {
  std::vector<int> labels;
  for (const models::TargetBelief& target : belief.targets) {
    labels.push_back(target.target_id);
  }
  return labels;
}

void expect_same(const models::RobotBelief& a, const models::RobotBelief& b) {
  ASSERT_EQ(labels_of(a), labels_of(b));
  for (std::size_t m = 0; m < a.targets.size(); ++m) {
    EXPECT_EQ(a.targets[m].information.vector, b.targets[m].information.vector);
    EXPECT_EQ(a.targets[m].information.matrix, b.targets[m].information.matrix);
    EXPECT_EQ(a.targets[m].last_seen, b.targets[m].last_seen);
  }
}

/// Three robots; `hears(k, i, j)` is true if robot i receives at step k what robot j sent.
struct Team {
  std::vector<DistributedFilter> robots;
  std::vector<models::RobotBelief> beliefs = std::vector<models::RobotBelief>(kRobots);
  Scene scene;
  bool is_told_beliefs = true;

  explicit Team(unsigned seed) : scene(seed) {
    for (std::size_t i = 0; i < kRobots; ++i) {
      robots.emplace_back(spec_of(i));
    }
  }

  template <class Hears>
  void step(int k, const Hears& hears) {
    const std::vector<models::RobotMeasurement> looks = scene.looks(k);
    std::vector<models::RobotBelief> next;
    for (std::size_t i = 0; i < kRobots; ++i) {
      test::Received received =
          test::received_by(i, looks, beliefs, [&](std::size_t j) { return hears(k, i, j); });
      if (!is_told_beliefs) {
        received.beliefs.clear();
      }
      std::shuffle(received.looks.begin(), received.looks.end(), scene.rng());
      next.push_back(
          take_step(robots[i], instant(k), Scene::place(k, i), received.looks, received.beliefs));
    }
    beliefs = next;
  }

  [[nodiscard]] bool agrees() const {
    return labels_of(beliefs[0]) == labels_of(beliefs[1]) &&
           labels_of(beliefs[1]) == labels_of(beliefs[2]);
  }
};

TEST(UnnamedTeam, HasIdenticalTracksWithFullCommunication) {
  Team team(1);
  for (int k = 1; k <= 80; ++k) {
    team.step(k, [](int, std::size_t, std::size_t) { return true; });
    for (std::size_t i = 1; i < kRobots; ++i) {
      expect_same(team.beliefs[i], team.beliefs[0]);
    }
  }
  EXPECT_EQ(team.beliefs[0].targets.size(), static_cast<std::size_t>(kTargets));
  for (const DistributedFilter& robot : team.robots) {
    const Reconciled& done = robot.counters().reconciled;
    EXPECT_EQ(done.relabelled + done.adopted + done.taken_over, 0);
    EXPECT_TRUE(robot.counters().named().empty());
  }
}

TEST(UnnamedTeam, UsesEachMeasurementOnce) {
  Scene scene(2);
  DistributedFilter once(spec_of(0));
  DistributedFilter twice(spec_of(0));
  for (int k = 1; k <= 40; ++k) {
    const std::vector<models::RobotMeasurement> looks = scene.looks(k);
    std::vector<models::RobotMeasurement> repeated = looks;
    repeated.insert(repeated.end(), looks.begin(), looks.end());
    const auto one = take_step(once, instant(k), Scene::place(k, 0), looks);
    expect_same(take_step(twice, instant(k), Scene::place(k, 0), repeated), one);
  }
  EXPECT_EQ(twice.counters().repeated_looks, 40 * static_cast<int>(kRobots));
}

TEST(UnnamedTeam, UsesALateMeasurementAtItsTime) {
  Scene scene(3);
  DistributedFilter timely(spec_of(0));
  DistributedFilter late(spec_of(0));
  std::vector<models::RobotMeasurement> held;
  for (int k = 1; k <= 40; ++k) {
    const std::vector<models::RobotMeasurement> looks = scene.looks(k);
    const auto one = take_step(timely, instant(k), Scene::place(k, 0), looks);
    std::vector<models::RobotMeasurement> arrived = held;
    arrived.push_back(looks[0]);
    held = {looks[1], looks[2]};
    if (k == 1 || k == 40) {  // a filter has no history before its first step
      arrived.insert(arrived.end(), held.begin(), held.end());
      held.clear();
    }
    const auto other = take_step(late, instant(k), Scene::place(k, 0), arrived);
    if (k == 40) {
      expect_same(other, one);
    }
  }
}

TEST(UnnamedTeam, AgreesOnLabelsDespiteLoss) {
  double agreed[2] = {0.0, 0.0};
  int healed = 0;
  constexpr int kSeeds = 10;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    for (const bool is_told_beliefs : {false, true}) {
      Team team(seed);
      team.is_told_beliefs = is_told_beliefs;
      std::mt19937_64 lottery(seed);
      std::bernoulli_distribution is_lost(0.2);
      for (int k = 1; k <= 100; ++k) {
        team.step(
            k, [&](int step, std::size_t, std::size_t) { return step > 80 || !is_lost(lottery); });
        agreed[is_told_beliefs ? 1 : 0] += k > 20 && k <= 80 && team.agrees() ? 1.0 / 60.0 : 0.0;
      }
      healed += is_told_beliefs && team.agrees() ? 1 : 0;
    }
  }
  RecordProperty("agreed_alone", std::to_string(agreed[0] / kSeeds));
  RecordProperty("agreed_told", std::to_string(agreed[1] / kSeeds));
  EXPECT_GT(agreed[1], agreed[0]);
  EXPECT_GE(agreed[1] / kSeeds, 0.8);
  EXPECT_EQ(healed, kSeeds);
}

// A robot that joins later adopts the track labels of its teammates from their first received
// beliefs.
TEST(UnnamedTeam, LateJoinerAdoptsTeamLabels) {
  Team team(5);
  const auto all = [](int, std::size_t, std::size_t) { return true; };
  for (int k = 1; k <= 40; ++k) {
    team.step(k, all);
  }
  team.robots[2] = DistributedFilter(spec_of(2));
  team.beliefs[2] = {};
  team.step(41, all);
  team.step(42, all);
  EXPECT_EQ(labels_of(team.beliefs[2]), labels_of(team.beliefs[0]));
  EXPECT_GE(labels_of(team.beliefs[2]).size(), 3U);
}

TEST(UnnamedTeam, ReportsExistenceProbabilities) {
  Team team(7);
  for (int k = 1; k <= 40; ++k) {
    team.step(k, [](int, std::size_t, std::size_t) { return true; });
    const models::BeliefMixture mixture = team.robots[0].mixture();
    const models::RobotBelief& belief = team.beliefs[0];
    EXPECT_EQ(mixture.stamp.time, belief.stamp.time);
    ASSERT_EQ(mixture.targets.size(), belief.targets.size());
    for (std::size_t i = 0; i < mixture.targets.size(); ++i) {
      const models::TargetMixture& target = mixture.targets[i];
      EXPECT_EQ(target.target_id, belief.targets[i].target_id);
      EXPECT_GT(target.existence, 0.5) << "the track is published";
      EXPECT_LE(target.existence, 1.0);
      for (const Component& component : target.components) {
        EXPECT_GT(component.weight, 0.0);
        EXPECT_LE(component.weight, 1.0);
      }
      const models::Gaussian published = *models::to_gaussian(belief.targets[i].information);
      const models::Gaussian together = moments(target.components);
      EXPECT_TRUE(is_near(together.mean, published.mean, 1e-6));
      EXPECT_TRUE(is_near(together.covariance, published.covariance, 1e-6));
    }
  }
}

TEST(UnnamedTeam, ContinuesWithTheLabelsOfALoggedBelief) {
  Team team(6);
  for (int k = 1; k <= 40; ++k) {
    team.step(k, [](int, std::size_t, std::size_t) { return true; });
  }
  DistributedFilter again(spec_of(0));
  again.rebase(team.beliefs[0]);
  EXPECT_EQ(labels_of(again.belief()), labels_of(team.beliefs[0]));
}

TEST(UnnamedTeam, RefusesUnsupportedSpecs) {
  FilterSpec spec = spec_of(0);
  spec.neighbourhood_m = 10.0;
  EXPECT_THROW(DistributedFilter{spec}, UsageError);
  spec = spec_of(0);
  spec.estimator.target_model = {models::TargetKind::kRandomWalk, 3, 0.02};
  EXPECT_THROW(DistributedFilter{spec}, UsageError);
  spec = spec_of(0);
  spec.team.resize(kLabelledRobots + 1, spec.team.front());
  EXPECT_THROW(DistributedFilter{spec}, UsageError);
}

TEST(UnnamedTeam, DropsInvalidAndExcessTracks) {
  DistributedFilter filter(spec_of(0));
  Scene scene(7);
  auto looks = scene.looks(1);
  models::Detection one = looks[0].detections.at(0);
  looks[0].detections.assign(40, one);
  one.measurement.z = one.measurement.z.tail(1).eval();
  looks[1].detections.assign(1, one);
  models::RobotBelief stranger;
  stranger.robot = robot_name(1);
  stranger.stamp.time = instant(1);
  stranger.targets.push_back({3, {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}, {}});
  take_step(filter, instant(1), Scene::place(1, 0), looks, {stranger});
  EXPECT_EQ(filter.counters().surplus_detections, 8);
  EXPECT_EQ(filter.counters().malformed_detections, 1);
  EXPECT_EQ(filter.counters().unknown_ids, 1);
}

// A belief may contain as many tracks as a team has room for. A belief with 100,000 tracks does not
// increase the memory use.
TEST(UnnamedTeam, LimitsReceivedTracks) {
  DistributedFilter filter(spec_of(0));
  models::RobotBelief stranger;
  stranger.robot = robot_name(1);
  stranger.stamp.time = instant(1);
  constexpr int kTold = 100'000;
  constexpr int kRoom = static_cast<int>(kRobots) * 2 * kTargets;
  for (int i = 0; i < kTold; ++i) {
    stranger.targets.push_back({models::kTrackLabelMin + i,
                                {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()},
                                instant(1)});
  }
  take_step(filter, instant(1), Scene::place(1, 0), {}, {stranger});
  EXPECT_EQ(filter.counters().malformed_beliefs, kTold - kRoom);
  EXPECT_LE(filter.mixture().targets.size(), std::size_t{2 * kTargets});
}

TEST(UnnamedTeam, AllocatesNothing) {
  if (!vantage::test::AllocationCounter::is_active()) {
    GTEST_SKIP() << "a sanitizer replaces the allocator";
  }
  Scene scene(8);
  DistributedFilter filter(spec_of(0));
  DistributedFilter teammate(spec_of(1));
  models::RobotBelief huge;
  std::size_t allocations = 0;
  for (int k = 1; k <= 60; ++k) {
    const auto looks = scene.looks(k);
    const std::vector<const models::RobotMeasurement*> pointers = {&looks[0], &looks[1], &looks[2]};
    const std::vector<const models::RobotBelief*> beliefs = {&huge};
    StepInput input{instant(k), Scene::place(k, 0), pointers, {}};
    if (k > 1) {
      huge.last_seen_utime.clear();  // a grid would allocate
      input.beliefs = beliefs;
    }
    const vantage::test::AllocationCounter counter;
    filter.advance(input);
    allocations += k > 1 ? counter.count() : 0;
    huge = take_step(teammate, instant(k), Scene::place(k, 1), {looks[1]});
  }
  EXPECT_EQ(allocations, 0U);
}

// A track received in the middle of a step is predicted to the end of the step. The prediction uses
// the elapsed time, and the time between the target's last observation and the sending of the
// track.
TEST(UnnamedTeam, PropagatesReceivedTracksToTheEndOfTheStep) {
  const auto variance_m2 = [](const models::TargetModel& model, Time sent_at, Time last_seen) {
    FilterSpec spec = spec_of(0);
    spec.estimator.target_model = model;
    DistributedFilter filter(spec);
    take_step(filter, instant(0), at(0, 0), {});
    models::RobotBelief received = test::prior(
        sent_at, {{Eigen::Vector2d(1.0, 2.0), 0.04 * models::StateMatrix::Identity(2, 2)}});
    received.robot = "Q2";
    received.targets[0].target_id = models::kTrackLabelMin + 7;
    received.targets[0].last_seen = last_seen;
    const models::RobotBelief own = take_step(filter, instant(2), at(0, 0), {}, {received});
    EXPECT_EQ(labels_of(own), std::vector{models::kTrackLabelMin + 7});
    EXPECT_EQ(own.targets.at(0).last_seen, last_seen);
    const models::Gaussian belief = *models::to_gaussian(own.targets.at(0).information);
    EXPECT_TRUE(is_near(belief.mean, Eigen::Vector2d(1.0, 2.0), 1e-9));
    EXPECT_NEAR(belief.covariance(0, 0), belief.covariance(1, 1), 1e-12);
    return belief.covariance(0, 0);
  };
  const models::TargetModel walk{models::TargetKind::kRandomWalk, 2, 0.02};
  EXPECT_NEAR(variance_m2(walk, instant(0), instant(-4)), 0.04 + 0.02 * 1.0, 1e-9);
  EXPECT_NEAR(variance_m2(walk, instant(0) + from_seconds(0.4), instant(-4)), 0.04 + 0.02 * 0.6,
              1e-9);
  EXPECT_NEAR(variance_m2(walk, instant(2), instant(-4)), 0.04, 1e-9);
  const models::TargetModel growing{models::TargetKind::kGrowingUncertainty, 2, 0.01};
  // The prediction is one step with the noise of the third step since the last observation.
  EXPECT_NEAR(variance_m2(growing, instant(1), instant(-2)), 0.04 + 0.01 * 3, 1e-9);
  EXPECT_NEAR(variance_m2(growing, instant(1), instant(1)), 0.04, 1e-9);
}

}  // namespace
}  // namespace vantage::estimator
