#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/check.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "test/estimator/filter_support.hpp"
#include "test/support/near.hpp"
#include "test/support/random.hpp"

// Tests of the fusion of teammates' beliefs into a filter, and of the restart of a filter from its
// own published belief.

namespace vantage::estimator {
namespace {

using namespace test::words;  // NOLINT(google-build-using-namespace): names for tests
using vantage::test::is_near;

FilterSpec still_spec(int targets, double communication_range_m = 5.0) {
  FilterSpec spec =
      open_spec({TargetKind::kStatic, 2, 0.0}, test::far_sighted(SensorKind::kPosition), targets);
  spec.communication_range_m = communication_range_m;
  return spec;
}

models::RobotBelief belief_of(const char* robot, Time time, const std::vector<Gaussian>& targets) {
  models::RobotBelief belief = test::prior(time, targets);
  belief.robot = robot;
  return belief;
}

Gaussian around(double x_m, double y_m, const Eigen::Matrix2d& covariance_m2) {
  return {Eigen::Vector2d(x_m, y_m), covariance_m2};
}

const std::vector<Gaussian> kOne = {around(3.0, 4.0, 0.5 * Eigen::Matrix2d::Identity())};

TEST(Reception, AcceptsBeliefsUpToTheStatedAge) {
  const models::RobotBelief received = belief_of("Q2", instant(9), kOne);
  const auto after = [&](Time now) {
    DistributedFilter filter(still_spec(1));
    take_step(filter, now, at(0, 0), {}, {received});
    return filter;
  };
  const Duration age_max = from_seconds(still_spec(1).belief_age_max_s);
  for (const Duration age : {Duration{0}, age_max}) {
    const DistributedFilter fresh = after(instant(9) + age);
    EXPECT_EQ(fresh.belief().targets.size(), 1U);
    EXPECT_EQ(fresh.belief().degree, 1);
    EXPECT_TRUE(fresh.counters().named().empty());
  }
  const DistributedFilter stale = after(instant(9) + age_max + Duration{1});
  EXPECT_TRUE(stale.belief().targets.empty());
  EXPECT_EQ(stale.counters().stale_beliefs, 1);
  EXPECT_EQ(stale.counters().future_beliefs, 0);
  const DistributedFilter future = after(instant(9) - Duration{1});
  EXPECT_TRUE(future.belief().targets.empty());
  EXPECT_EQ(future.counters().future_beliefs, 1);
  EXPECT_EQ(future.counters().stale_beliefs, 0);
}

// The radio range is a distance in space and limits both beliefs and observations.
TEST(Reception, IsLimitedToExactlyTheRadioRange) {
  for (const double aside : {-1.0, 1.0}) {
    for (const auto& [height_m, is_near] : {std::pair(0.0, true), std::pair(0.01, false)}) {
      FilterSpec spec = still_spec(1);
      spec.team = {{"Q1", spec.sensor}, {"Q2", spec.sensor}};
      models::Viewpoint there = at(aside * 3.0, -4.0);
      there.height_m = height_m;
      models::RobotBelief received = belief_of("Q2", instant(1), kOne);
      received.viewpoint = there;
      DistributedFilter receiver(spec);
      EXPECT_EQ(take_step(receiver, instant(1), at(0, 0), {}, {received}).targets.empty(),
                !is_near);
      EXPECT_EQ(receiver.counters().out_of_range_beliefs, is_near ? 0 : 1);
      std::mt19937_64 rng(1);
      models::RobotMeasurement look =
          look_at(spec.sensor, instant(1), there, {Eigen::Vector2d(1.0, 1.0)}, rng);
      look.robot = "Q2";
      DistributedFilter looker(spec);
      EXPECT_EQ(take_step(looker, instant(1), at(0, 0), {look}).targets.empty(), !is_near);
      EXPECT_EQ(looker.counters().out_of_range_looks, is_near ? 0 : 1);
    }
  }
}

TEST(Reception, CountsTeammatesInRangeAtEachStep) {
  DistributedFilter filter(still_spec(1));
  std::vector<models::RobotBelief> received = {belief_of("Q2", instant(1), kOne),
                                               belief_of("Q3", instant(1), kOne),
                                               belief_of("Q4", instant(1), kOne)};
  received[1].viewpoint = at(9.0, 0.0);
  EXPECT_EQ(take_step(filter, instant(1), at(0, 0), {}, received).degree, 2);
  EXPECT_EQ(take_step(filter, instant(2), at(0, 0), {}, {received[0]}).degree, 1);
  EXPECT_EQ(take_step(filter, instant(3), at(0, 0), {}).degree, 0);
  EXPECT_EQ(filter.counters().out_of_range_beliefs, 1);
}

// Weights are proportional to √det Ω, in any order of arrival. The last observation is the latest
// of any robot.
TEST(BeliefFusion, FirstBeliefIsWeightedMeanOfTeammates) {
  const std::vector<Gaussian> of_one = {
      around(1.0, 0.0, Eigen::Vector2d(0.25, 1.0).asDiagonal()),         // diagonal of Ω: 4, 1
      around(3.0, 2.0, Eigen::Vector2d(1.0 / 9, 1.0 / 9).asDiagonal()),  // diagonal of Ω: 9, 9
      around(-2.0, 5.0,
             Eigen::Vector2d(1.0 / 16.0, 1.0 / 25).asDiagonal())};  // diagonal of Ω: 16, 25
  const double weights[] = {2.0, 9.0, 20.0};
  models::Information expected{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()};
  for (std::size_t i = 0; i < 3; ++i) {
    const models::Information theirs = models::to_information(of_one[i]).value();
    expected.matrix += weights[i] / 31.0 * theirs.matrix;
    expected.vector += weights[i] / 31.0 * theirs.vector;
  }
  std::vector<std::size_t> order = {0, 1, 2};
  do {
    std::vector<models::RobotBelief> received;
    for (const std::size_t i : order) {
      received.push_back(belief_of("Q2", instant(2), {of_one[i]}));
      received.back().targets[0].target_id = 3;
      received.back().targets[0].last_seen = instant(1) - static_cast<int>(i % 2) * Duration{7};
    }
    DistributedFilter filter(still_spec(4));
    const models::RobotBelief belief = take_step(filter, instant(2), at(0, 0), {}, received);
    ASSERT_EQ(belief.targets.size(), 1U);
    EXPECT_EQ(belief.targets[0].target_id, 3);
    EXPECT_EQ(belief.targets[0].last_seen, instant(1));
    EXPECT_TRUE(is_near(belief.targets[0].information.matrix, expected.matrix, 1e-12));
    EXPECT_TRUE(is_near(belief.targets[0].information.vector, expected.vector, 1e-12));
  } while (std::next_permutation(order.begin(), order.end()));
}

// The weight κ is compared with the best κ of a search over all values.
TEST(BeliefFusion, WeightsATeammateToMaximiseTheDeterminant) {
  vantage::test::Random random(6);
  int between = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const models::Information own{random.vector<2>(-3.0, 3.0), random.spd(2, 0.1)};
    const models::Information theirs{random.vector<2>(-3.0, 3.0), random.spd(2, 0.1)};
    double best = 0.0;
    double best_det = 0.0;
    for (int k = 0; k <= 20'000; ++k) {
      const double kappa = k / 20'000.0;
      const double det =
          Eigen::Matrix2d(own.matrix + kappa * (theirs.matrix - own.matrix)).determinant();
      best = det > best_det ? kappa : best;
      best_det = std::max(best_det, det);
    }
    DistributedFilter filter(still_spec(1));
    models::RobotBelief known_before;
    known_before.stamp.time = instant(1);
    known_before.targets = {{0, own, instant(1)}};
    filter.rebase(known_before);
    models::RobotBelief received = known_before;
    received.robot = "Q2";
    received.stamp.time = instant(2);
    received.targets = {{0, theirs, instant(2)}};
    take_step(filter, instant(2), at(0, 0), {}, {received});
    const Track after = filter.track(0);
    const models::StateMatrix off = theirs.matrix - own.matrix;
    const double kappa = (after.information.matrix - own.matrix)(0, 0) / off(0, 0);
    EXPECT_NEAR(kappa, best, 3e-4) << trial;
    EXPECT_TRUE(is_near(after.information.matrix, own.matrix + kappa * off, 1e-9));
    EXPECT_TRUE(
        is_near(after.information.vector, own.vector + kappa * (theirs.vector - own.vector), 1e-9));
    EXPECT_EQ(after.last_seen, instant(best > 0.0 ? 2 : 1)) << trial;
    EXPECT_EQ(best == 0.0, after.information.matrix == own.matrix) << trial;
    between += best > 0.0 && best < 1.0 ? 1 : 0;
  }
  EXPECT_GT(between, 20);
}

TEST(Reception, CountsBeliefsOfUnknownTargets) {
  const models::TargetModel model{TargetKind::kDoubleIntegrator, 2, 0.1};
  FilterSpec spec = open_spec(model, test::far_sighted(SensorKind::kPosition), 3);
  spec.communication_range_m = 5.0;
  const models::Information good =
      models::to_information({Eigen::Vector4d(1, 2, 0, 0), Eigen::Matrix4d::Identity()}).value();
  struct Wrong {
    models::TargetBelief belief_of_target;
    std::int64_t FilterCounters::*counter;
  };
  const auto of = [](const models::StateVector& vector, const models::StateMatrix& matrix) {
    return models::TargetBelief{1, {vector, matrix}, instant(1)};
  };
  const models::StateVector v = good.vector;
  const models::StateMatrix M = good.matrix;
  const std::vector<Wrong> all = {
      {{-1, good, instant(1)}, &FilterCounters::unknown_ids},
      {{3, good, instant(1)}, &FilterCounters::unknown_ids},
      {of(v.head(3), M), &FilterCounters::malformed_beliefs},
      {of(v, M.topRows(3)), &FilterCounters::malformed_beliefs},
      {of(v, M.leftCols(3)), &FilterCounters::malformed_beliefs},
      {of(v, models::StateMatrix::Zero(4, 4)), &FilterCounters::singular},
      {of(v, -M), &FilterCounters::singular},
      {of(v, 1e200 * M), &FilterCounters::singular},  // infinite determinant
  };
  for (const Wrong& wrong : all) {
    for (const Time sent_at : {instant(1), instant(2)}) {
      if (&wrong == &all.back() && sent_at < instant(2)) {
        continue;  // changed by prediction
      }
      DistributedFilter filter(spec);
      models::RobotBelief received = belief_of("Q2", sent_at, {});
      received.targets = {{0, good, instant(1)}, wrong.belief_of_target, {2, good, instant(1)}};
      const models::RobotBelief belief = take_step(filter, instant(2), at(0, 0), {}, {received});
      ASSERT_EQ(belief.targets.size(), 2U) << wrong.belief_of_target.target_id;
      EXPECT_EQ(belief.targets[0].target_id, 0);
      EXPECT_EQ(belief.targets[1].target_id, 2);
      EXPECT_EQ(filter.counters().*wrong.counter, 1);
      EXPECT_EQ(filter.counters().named().size(), 1U);
    }
  }
}

TEST(BeliefFusion, CountsGridMismatchOnlyWhenGridIsPresent) {
  DistributedFilter filter(still_spec(1));
  models::RobotBelief received = belief_of("Q2", instant(1), kOne);
  take_step(filter, instant(1), at(0, 0), {}, {received});
  EXPECT_EQ(filter.counters().grid_mismatches, 0);
  received.stamp.time = instant(2);
  received.grid = filter.grid().geometry();
  received.last_seen_utime.assign(filter.grid().last_seen_utime().size() + 1, 0);
  take_step(filter, instant(2), at(0, 0), {}, {received});
  EXPECT_EQ(filter.counters().grid_mismatches, 1);
  received.stamp.time = instant(3);
  received.last_seen_utime.pop_back();
  take_step(filter, instant(3), at(0, 0), {}, {received});
  EXPECT_EQ(filter.counters().grid_mismatches, 1);
}

// A belief that is two steps old is predicted with reflection at walls in both steps. When the
// filter receives its own old belief, its mean and covariance therefore do not change.
TEST(BeliefFusion, ReflectsOldBeliefsAtWalls) {
  for (const bool stay_inside : {false, true}) {
    for (const double x_m : {0.0, 19.7}) {
      FilterSpec spec = open_spec({TargetKind::kDoubleIntegrator, 2, 0.001},
                                  test::far_sighted(SensorKind::kPosition), 1);
      spec.estimator.targets_stay_inside = stay_inside;
      spec.communication_range_m = 100.0;
      Gaussian leaving{Eigen::Vector4d(x_m, 0.0, 0.6, 0.0), Eigen::Matrix4d::Zero()};
      leaving.covariance.diagonal() << 0.01, 0.0025, 0.04, 0.04;
      const models::RobotBelief received = belief_of("Q2", instant(0), {leaving});
      DistributedFilter alone(spec);
      DistributedFilter receiver(spec);
      for (DistributedFilter* filter : {&alone, &receiver}) {
        filter->rebase(test::prior(instant(0), {leaving}));
        take_step(*filter, instant(1), at(0, 0), {});
      }
      take_step(alone, instant(2), at(0, 0), {});
      take_step(receiver, instant(2), at(0, 0), {}, {received});
      EXPECT_EQ(receiver.belief().degree, 1);
      EXPECT_TRUE(is_near(known(receiver, 0).mean, known(alone, 0).mean, 1e-9));
      EXPECT_TRUE(is_near(known(receiver, 0).covariance, known(alone, 0).covariance, 1e-9));
    }
  }
}

// A filter restarted from a belief publishes the same belief.
TEST(Rebase, ContinuesFromACompleteBelief) {
  DistributedFilter filter(still_spec(5));
  models::RobotBelief before = belief_of("Q1", instant(3),
                                         {around(1, 2, 0.3 * Eigen::Matrix2d::Identity()),
                                          around(3, 4, 0.4 * Eigen::Matrix2d::Identity())});
  before.targets[1].target_id = 4;
  before.targets[1].last_seen = instant(1);
  before.viewpoint = at(1.5, -2.5, 0.7);
  before.viewpoint.height_m = 1.2;
  before.degree = 3;
  before.grid = filter.grid().geometry();
  before.last_seen_utime.assign(filter.grid().last_seen_utime().size(), 0);
  before.last_seen_utime[5] = to_utime(instant(2));
  filter.rebase(belief_of("Q1", instant(2), {kOne[0], kOne[0], kOne[0]}));  // is overwritten
  filter.rebase(before);
  const models::RobotBelief after = filter.belief();
  EXPECT_EQ(after.stamp.time, instant(3));
  EXPECT_EQ(after.robot, "Q1");
  EXPECT_EQ(after.viewpoint.world_from_body, before.viewpoint.world_from_body);
  EXPECT_EQ(after.viewpoint.height_m, 1.2);
  EXPECT_EQ(after.degree, 3);
  EXPECT_EQ(after.grid, before.grid);
  EXPECT_EQ(after.last_seen_utime, before.last_seen_utime);
  ASSERT_EQ(after.targets.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after.targets[i].target_id, before.targets[i].target_id);
    EXPECT_EQ(after.targets[i].last_seen, before.targets[i].last_seen);
    EXPECT_EQ(after.targets[i].information.matrix, before.targets[i].information.matrix);
    EXPECT_EQ(after.targets[i].information.vector, before.targets[i].information.vector);
  }
  EXPECT_TRUE(filter.counters().named().empty());
  // A step at the time of the belief or earlier is rejected.
  EXPECT_EQ(take_step(filter, instant(3), at(0, 0), {}).viewpoint.height_m, 1.2);
  EXPECT_EQ(filter.counters().steps_out_of_order, 1);
}

TEST(Rebase, CountsBeliefsOfAnotherFilter) {
  DistributedFilter filter(still_spec(2));
  models::RobotBelief before = belief_of("Q1", instant(3), {kOne[0], kOne[0], kOne[0], kOne[0]});
  before.targets[0].target_id = -1;
  before.targets[1].target_id = 2;
  before.targets[2].target_id = 0;
  before.targets[2].information.vector.resize(3);
  before.targets[3].target_id = 1;
  filter.rebase(before);
  ASSERT_EQ(filter.belief().targets.size(), 1U);
  EXPECT_EQ(filter.belief().targets[0].target_id, 1);
  EXPECT_EQ(filter.counters().unknown_ids, 2);
  EXPECT_EQ(filter.counters().malformed_beliefs, 1);
  EXPECT_EQ(filter.counters().grid_mismatches, 0) << "the belief has no grid";
  before.targets.clear();
  before.grid = filter.grid().geometry();
  before.last_seen_utime.assign(filter.grid().last_seen_utime().size() + 1, 7);
  filter.rebase(before);
  EXPECT_EQ(filter.counters().grid_mismatches, 1)
      << "the number of stamps differs from the number of cells";
  before.last_seen_utime.pop_back();
  before.grid.origin_m.x() += 1.0;
  filter.rebase(before);
  EXPECT_EQ(filter.counters().grid_mismatches, 2) << "other cells";
  EXPECT_EQ(filter.grid().last_seen_utime()[0], models::VisibilityGrid::kNeverSeen);
}

TEST(FilterSpec, IsReadFromTheScenario) {
  scenario::Scenario scenario;
  scenario.world.bounds = {{-3.0, -2.0}, {5.0, 4.0}};
  for (int i = 0; i < 3; ++i) {
    scenario::RobotSpec robot;
    robot.name = std::string("Q") + std::to_string(i + 1);
    robot.start = {1.0 * i, 2.0 * i, 0.1 * i};
    robot.height_m = 1.0 + 0.5 * i;
    robot.sensor.range_max_m = 3.0 + i;
    robot.detection.clutter_per_look = 0.5 * i;
    scenario.robots.push_back(robot);
  }
  scenario.estimator.gate_sigma = 3.5;
  scenario.estimator.grid_resolution_m = 0.75;
  scenario.planner.step_s = 0.25;
  scenario.network.communication_range_m = 7.0;
  scenario.network.neighbourhood_m = 9.0;
  const FilterSpec none = filter_spec(scenario, "Q2");
  EXPECT_EQ(none.target_count, 0);
  EXPECT_EQ(none.target_radius_m, 0.0);
  const std::vector<std::pair<int, double>> targets = {{2, 0.3}, {0, 0.2}, {1, 0.25}};
  for (const auto& [id, radius_m] : targets) {
    scenario.targets.push_back({"T" + std::to_string(id), id, std::nullopt, radius_m});
  }
  const FilterSpec spec = filter_spec(scenario, "Q2");
  EXPECT_EQ(spec.robot, "Q2");
  EXPECT_EQ(spec.sensor.range_max_m, 4.0);
  EXPECT_EQ(spec.detection.clutter_per_look, 0.5);
  EXPECT_EQ(spec.start.world_from_body, (Pose2{1.0, 2.0, 0.1}));
  EXPECT_EQ(spec.start.height_m, 1.5);
  ASSERT_EQ(spec.team.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(spec.team[i].robot, scenario.robots[i].name);
    EXPECT_EQ(spec.team[i].sensor.range_max_m, scenario.robots[i].sensor.range_max_m);
    EXPECT_EQ(spec.team[i].detection.clutter_per_look,
              scenario.robots[i].detection.clutter_per_look);
  }
  EXPECT_EQ(spec.estimator.gate_sigma, 3.5);
  EXPECT_EQ(spec.world.bounds.max_m, scenario.world.bounds.max_m);
  EXPECT_EQ(spec.target_count, 3) << "the last one in the list";
  EXPECT_EQ(spec.target_radius_m, 0.2) << "the smallest";
  EXPECT_EQ(spec.step_s, 0.25);
  EXPECT_EQ(spec.communication_range_m, 7.0);
  EXPECT_EQ(spec.neighbourhood_m, 9.0);
  EXPECT_EQ(spec.belief_age_max_s, 0.75);
  // Before its first step a filter reports its start as its viewpoint.
  EXPECT_EQ(DistributedFilter(spec).belief().viewpoint.height_m, 1.5);
}

TEST(DistributedFilter, RefusesInvalidSpecs) {
  const auto is_refused = [](auto change) {
    FilterSpec spec = still_spec(1);
    change(spec);
    try {
      DistributedFilter filter(spec);
    } catch (const UsageError&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused([](FilterSpec& spec) { spec.target_count = 0; }));
  EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.target_count = -1; }));
  EXPECT_FALSE(is_refused([](FilterSpec& spec) { spec.step_s = 1e-3; }));
  EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.step_s = 0.0; }));
  EXPECT_FALSE(is_refused([](FilterSpec& spec) { spec.history_steps = 1; }));
  EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.history_steps = 0; }));
  EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.estimator.prior_position_sigma_m = 0.0; }));
  EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.estimator.prior_velocity_sigma_mps = 0.0; }));
}

// Tests each case alone: an unknown target id, a second detection of one target, a covariance of
// the wrong size.
TEST(DistributedFilter, CountsEachUnusableDetection) {
  const FilterSpec spec = still_spec(3);
  std::mt19937_64 rng(2);
  const models::RobotMeasurement good =
      look_at(spec.sensor, instant(1), at(0, 0), {{1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}}, rng);
  const auto counters = [&](auto change) {
    models::RobotMeasurement look = good;
    change(look.detections[1]);
    DistributedFilter filter(spec);
    EXPECT_EQ(take_step(filter, instant(1), at(0, 0), {look}).targets.size(), 2U);
    EXPECT_EQ(filter.counters().named().size(), 1U);
    return filter.counters();
  };
  using models::Detection;
  EXPECT_EQ(counters([](Detection& d) { d.target_id = -1; }).unknown_ids, 1);
  EXPECT_EQ(counters([](Detection& d) { d.target_id = 3; }).unknown_ids, 1);
  EXPECT_EQ(counters([](Detection& d) { d.target_id = 0; }).malformed_detections, 1);
  EXPECT_EQ(counters([](Detection& d) { d.measurement.z.resize(1); }).malformed_detections, 1);
  EXPECT_EQ(counters([](Detection& d) { d.measurement.V.resize(1, 2); }).malformed_detections, 1);
  EXPECT_EQ(counters([](Detection& d) { d.measurement.V.resize(2, 1); }).malformed_detections, 1);
}

}  // namespace
}  // namespace vantage::estimator
