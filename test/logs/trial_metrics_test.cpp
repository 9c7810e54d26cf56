#include "logs/metrics/trial_metrics.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr double kPriorSigma_m = 4.0;

Time at_s(double seconds_s) { return from_utime(kStart) + from_seconds(seconds_s); }

scenario::Scenario scenario() {
  scenario::Scenario out;
  out.name = "bench";
  out.seed = 7;
  out.planner.step_s = 0.5;
  out.estimator.target_model.position_dim = 2;
  out.estimator.undiscovered_position_sigma_m = kPriorSigma_m;
  out.robots.resize(2);
  out.robots[0].name = "Q1";
  out.robots[1].name = "Q2";
  out.targets.resize(2);
  out.targets[0].name = "R1";
  out.targets[1].name = "R2";
  out.targets[1].id = 1;
  return out;
}

// Returns a frame in which target 0 has moved along x from the origin at 2 m/s, and target 1 is
// stationary at (5, 5).
models::TruthFrame truth(double time_s) {
  models::TruthFrame out;
  out.stamp.time = at_s(time_s);
  out.bodies.resize(2);
  out.bodies[0].target_id = 0;
  out.bodies[0].world_from_body = lift({2.0 * time_s, 0.0, 0.0}, 0.0);
  out.bodies[1].target_id = 1;
  out.bodies[1].world_from_body = lift({5.0, 5.0, 0.0}, 0.0);
  return out;
}

models::TargetBelief target(int id, double x_m, double y_m, double sigma_m) {
  models::TargetBelief out;
  out.target_id = id;
  out.information.matrix = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
  out.information.vector = Eigen::Vector2d(x_m, y_m) / (sigma_m * sigma_m);
  return out;
}

models::RobotBelief belief(const std::string& robot, double time_s,
                           std::vector<models::TargetBelief> targets) {
  models::RobotBelief out;
  out.robot = robot;
  out.stamp.time = at_s(time_s);
  out.targets = std::move(targets);
  return out;
}

TEST(TrialMetrics, EvaluatesErrorsAtTheBeliefsTime) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  // Truth between frames: at 0.5 s target 0 is at x = 1; the belief is off by (0.3, 0.4).
  metrics.on_belief(belief("Q1", 0.5, {target(0, 1.3, 0.4, 1.0)}));
  metrics.on_truth(truth(0.4));
  metrics.on_truth(truth(0.6));
  const TrialSummary summary = metrics.finish(at_s(1.0));
  ASSERT_TRUE(summary.rmse_m);
  EXPECT_NEAR(*summary.rmse_m, 0.5, 1e-9);
  EXPECT_NEAR(*summary.rmse_per_target_m[0], 0.5, 1e-9);
  EXPECT_FALSE(summary.rmse_per_target_m[1]);
}

// Labels are not ids: each track is evaluated against the target of the best assignment. A track
// far from all targets counts as no discovery.
TEST(TrialMetrics, AssignsTracksWithoutIdsByPosition) {
  scenario::Scenario unnamed = scenario();
  for (scenario::RobotSpec& robot : unnamed.robots) {
    robot.detection.detects_ids = false;
  }
  TrialMetrics metrics(unnamed, at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(2.0));
  const int label = models::kTrackLabelMin;
  metrics.on_belief(belief("Q1", 0.5, {target(label, 5.0, 8.0, 1.0)}));
  metrics.on_belief(
      belief("Q1", 1.0, {target(label + 7, 5.0, 5.4, 1.0), target(label + 9, 2.3, 0.0, 1.0)}));
  metrics.on_belief(belief("Q1", 1.5,
                           {target(label, 3.0, 0.5, 1.0), target(label + 7, 5.0, 5.5, 1.0),
                            target(label + 9, 9.0, 9.0, 1.0)}));
  const TrialSummary summary = metrics.finish(at_s(2.0));
  EXPECT_EQ(summary.discovered, 2);
  EXPECT_EQ(summary.discovery_time_s[0], 1.0);
  EXPECT_EQ(summary.discovery_time_s[1], 1.0);
  EXPECT_NEAR(*summary.rmse_m, (3.0 + std::sqrt((0.16 + 0.09) / 2.0) + 0.5) / 3.0, 1e-9);
  EXPECT_NEAR(summary.undiscovered_share, 0.5 / 3.0, 1e-12);
}

TEST(TrialMetrics, UsesTheBestInformedRobotPerStep) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(2.0));
  metrics.on_belief(belief("Q1", 0.5, {target(0, 4.0, 0.0, 2.0)}));   // error 3 m, uncertain
  metrics.on_belief(belief("Q2", 0.5, {target(0, 1.0, 0.25, 0.5)}));  // error 0.25 m, certain
  const TrialSummary summary = metrics.finish(at_s(2.0));
  EXPECT_NEAR(*summary.rmse_m, 0.25, 1e-9);
  EXPECT_NEAR(summary.entropy_per_target_nats[0], isotropic_entropy_nats(0.5, 2), 1e-9);
}

TEST(TrialMetrics, ExcludesUnknownTargetsFromTheRmse) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(3.0));
  metrics.on_belief(belief("Q1", 0.5, {}));
  metrics.on_belief(belief("Q1", 1.0, {target(1, 5.0, 6.0, 1.0)}));
  const TrialSummary summary = metrics.finish(at_s(3.0));
  const double prior = isotropic_entropy_nats(kPriorSigma_m, 2);
  const double known = isotropic_entropy_nats(1.0, 2);
  EXPECT_NEAR(summary.entropy_per_target_nats[0], prior, 1e-9);
  EXPECT_NEAR(summary.entropy_per_target_nats[1], 0.5 * (prior + known), 1e-9);
  EXPECT_NEAR(summary.entropy_nats, 0.75 * prior + 0.25 * known, 1e-9);
  EXPECT_NEAR(*summary.rmse_m, 1.0, 1e-9);
  EXPECT_NEAR(summary.undiscovered_share, 0.75, 1e-12);
  EXPECT_EQ(summary.discovered, 1);
}

TEST(TrialMetrics, AveragesOverRobotsBeliefs) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(2.0));
  metrics.on_belief(belief("Q1", 0.5, {target(0, 4.0, 0.0, 2.0)}));   // error 3 m
  metrics.on_belief(belief("Q2", 0.5, {target(0, 1.0, 0.25, 0.5)}));  // error 0.25 m
  metrics.on_belief(belief("Q1", 1.0, {target(0, 2.0, 1.0, 2.0), target(1, 5.0, 6.0, 1.0)}));
  metrics.on_belief(belief("Q2", 1.0, {}));
  const RobotMeans means = metrics.finish(at_s(2.0)).per_robot;
  const double prior = isotropic_entropy_nats(kPriorSigma_m, 2);
  const auto known = [](double sigma_m) { return isotropic_entropy_nats(sigma_m, 2); };
  ASSERT_TRUE(means.rmse_m);
  // At 1.0 s, both of Q1's targets have an error of 1 m.
  EXPECT_NEAR(*means.rmse_m, 0.5 * (0.5 * (3.0 + 1.0) + 0.25), 1e-9);
  const double q1 = 0.25 * (known(2.0) + prior + known(2.0) + known(1.0));
  const double q2 = 0.25 * (known(0.5) + prior + 2.0 * prior);
  EXPECT_NEAR(means.entropy_nats, 0.5 * (q1 + q2), 1e-9);
  EXPECT_NEAR(means.undiscovered_share, 0.5 * (0.25 + 0.75), 1e-12);
  EXPECT_NEAR(means.discovered, 1.5, 1e-12);
  EXPECT_NEAR(means.discovery_time_s, 0.25 * (0.5 + 1.0 + 0.5 + 2.0), 1e-12);
}

TEST(TrialMetrics, CountsADiscoveryAtTheFirstBeliefOfAnyRobot) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_belief(belief("Q1", 2.0, {target(0, 0.0, 0.0, 1.0)}));
  metrics.on_belief(belief("Q2", 1.5, {target(0, 0.0, 0.0, 1.0)}));  // arrives later, is older
  metrics.on_belief(belief("Q2", 9.0, {target(0, 0.0, 0.0, 1.0)}));
  const TrialSummary summary = metrics.finish(at_s(10.0));
  ASSERT_TRUE(summary.discovery_time_s[0]);
  EXPECT_DOUBLE_EQ(*summary.discovery_time_s[0], 1.5);
  EXPECT_FALSE(summary.discovery_time_s[1]);
}

TEST(TrialMetrics, AveragesTheRmseOverTime) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(5.0));
  // The errors are 1 m, then 3 m and 0 m.
  metrics.on_belief(belief("Q1", 0.5, {target(0, 1.0, 1.0, 1.0)}));
  metrics.on_belief(belief("Q1", 1.0, {target(0, 2.0, 3.0, 1.0), target(1, 5, 5, 1.0)}));
  const TrialSummary summary = metrics.finish(at_s(5.0));
  EXPECT_NEAR(*summary.rmse_m, 0.5 * (1.0 + std::sqrt(9.0 / 2.0)), 1e-9);
  EXPECT_NEAR(*summary.rmse_per_target_m[0], std::sqrt(5.0), 1e-9);
}

TEST(TrialMetrics, ReportsConsistency) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(5.0));
  metrics.on_belief(belief("Q1", 0.5, {target(0, 1.0, 1.0, 0.5)}));  // error 2 σ
  metrics.on_belief(belief("Q1", 1.0, {target(0, 2.0, 3.0, 3.0), target(1, 5, 5, 1.0)}));  // 1 σ, 0
  const TrialSummary summary = metrics.finish(at_s(5.0));
  ASSERT_TRUE(summary.position_nees);
  EXPECT_NEAR(*summary.position_nees, (4.0 + 1.0 + 0.0) / 3.0, 1e-9);
  EXPECT_FALSE(TrialMetrics(scenario(), at_s(0.0)).finish(at_s(1.0)).position_nees);
}

TEST(TrialMetrics, ReportsConsistencyByUnseenTime) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(5.0));
  models::TargetBelief fresh = target(0, 1.0, 1.0, 0.5);  // error 2 σ at 0.5 s: NEES 4
  fresh.last_seen = at_s(0.5);
  models::TargetBelief old = target(1, 5.0, 8.0, 1.0);  // error 3 σ: NEES 9, outside the ellipse
  old.last_seen = at_s(-2.5);
  metrics.on_belief(belief("Q1", 0.5, {fresh, old}));
  fresh.last_seen = at_s(-0.5);                                             // unseen for 1 s
  metrics.on_belief(belief("Q2", 0.5, {fresh, target(1, 5.0, 6.0, 1.0)}));  // NEES 1, never seen
  const RobotMeans means = metrics.finish(at_s(5.0)).per_robot;
  EXPECT_EQ(means.consistency.samples, 4);
  EXPECT_NEAR(*means.consistency.mean_nees, (4.0 + 9.0 + 4.0 + 1.0) / 4.0, 1e-9);
  EXPECT_NEAR(*means.consistency.coverage_95, 0.75, 1e-12);
  EXPECT_NEAR(*means.consistency_by_age[0].mean_nees, 4.0, 1e-9);
  EXPECT_EQ(means.consistency_by_age[1].samples, 1);
  EXPECT_NEAR(*means.consistency_by_age[2].mean_nees, 9.0, 1e-9);
  EXPECT_FALSE(means.consistency_by_age[3].mean_nees);
  EXPECT_NEAR(*means.consistency_by_age[4].mean_nees, 1.0, 1e-9);
}

TEST(TrialMetrics, ReportsTheNewestStepPerRobot) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  EXPECT_FALSE(metrics.step_of_robots().entropy_nats());
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(5.0));
  models::TargetBelief fresh = target(0, 1.0, 1.0, 0.5);  // error 1 m, which is 2 σ
  fresh.last_seen = at_s(0.5);
  models::TargetBelief old = target(1, 5.0, 8.0, 1.0);  // error 3 m and 3 σ
  old.last_seen = at_s(-2.5);
  metrics.on_belief(belief("Q1", 0.5, {fresh, old}));
  metrics.on_belief(belief("Q2", 0.5, {fresh}));
  metrics.on_belief(belief("Q3", 0.5, {}));  // knows nothing
  metrics.on_belief(belief("Q1", 1.0, {}));
  EXPECT_FALSE(metrics.step_of_robots().entropy_nats()) << "the first step is not evaluated yet";
  metrics.on_belief(belief("Q1", 1.5, {}));
  const RobotStep& step = metrics.step_of_robots();
  EXPECT_NEAR(step.rmse_m().value(), 0.5 * (std::sqrt((1.0 + 9.0) / 2.0) + 1.0), 1e-9);
  const double prior = isotropic_entropy_nats(kPriorSigma_m, 2);
  const double known_0 = isotropic_entropy_nats(0.5, 2);
  const double known_1 = isotropic_entropy_nats(1.0, 2);
  EXPECT_NEAR(step.entropy_nats().value(),
              (0.5 * (known_0 + known_1) + 0.5 * (known_0 + prior) + prior) / 3.0, 1e-9);
  EXPECT_EQ(step.nees_by_age()[0].samples, 2);
  EXPECT_NEAR(step.nees_by_age()[0].sum, 8.0, 1e-9);
  EXPECT_EQ(step.nees_by_age()[2].samples, 1);
  EXPECT_NEAR(step.nees_by_age()[2].sum, 9.0, 1e-9);
  metrics.on_belief(belief("Q1", 2.0, {}));
  EXPECT_FALSE(metrics.step_of_robots().rmse_m()) << "for the newest step only";
  EXPECT_EQ(metrics.step_of_robots().nees_by_age()[0].samples, 0);
}

TEST(NeesSums, MatchesAConsistentFilter) {
  for (const int dim : {2, 3}) {
    NeesSums sums(dim);
    std::mt19937_64 rng(4);
    std::chi_squared_distribution<double> chi_squared(dim);
    constexpr int kSamples = 40'000;
    for (int i = 0; i < kSamples; ++i) {
      sums.add(chi_squared(rng));
    }
    const Consistency found = sums.result();
    EXPECT_EQ(found.samples, kSamples);
    EXPECT_NEAR(*found.mean_nees, dim, 4.0 * std::sqrt(2.0 * dim / kSamples));
    EXPECT_NEAR(*found.median_nees, dim == 2 ? 2.0 * std::log(2.0) : 2.366, 0.04);
    EXPECT_NEAR(*found.coverage_95, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / kSamples));
  }
}

TEST(NeesSums, AcceptsErrorsOfAnySize) {
  NeesSums sums(2);
  for (const double nees : {0.0, 1e9, 3.0}) {
    sums.add(nees);
  }
  EXPECT_NEAR(*sums.result().median_nees, 3.0, 0.05);
  EXPECT_FALSE(NeesSums(2).result().median_nees);
}

TEST(AgeClass, IncludesItsLowerEdge) {
  EXPECT_EQ(age_class(-0.1), 0U);
  EXPECT_EQ(age_class(0.99), 0U);
  EXPECT_EQ(age_class(1.0), 1U);
  EXPECT_EQ(age_class(7.9), 3U);
  EXPECT_EQ(age_class(1e9), 4U);
  EXPECT_EQ(age_name(1), "1-2");
  EXPECT_EQ(age_name(4), "8+");
}

TEST(TrialMetrics, CountsRoundsPlansAndFallbacks) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.round = 10;
  plan.source = models::PlanSource::kSearched;
  metrics.on_plan(plan);
  plan.robot = "Q2";
  plan.late = true;
  metrics.on_plan(plan);
  plan.round = 11;
  plan.source = models::PlanSource::kBraking;
  metrics.on_plan(plan);
  const TrialSummary summary = metrics.finish(at_s(1.0));
  EXPECT_EQ(summary.rounds, 2);
  EXPECT_EQ(summary.rounds_late, 2);
  EXPECT_EQ(summary.fallbacks, 1);
  EXPECT_EQ(summary.plans, 3);
  EXPECT_EQ(summary.plans_missing, 1);
}

TEST(TrialMetrics, SumsPlannedEnergyUntilTheNextPlan) {
  scenario::Scenario world = scenario();
  world.planner.execute_steps = 3;
  world.world.regions = {{"wind", {{0.4, -1.0}, {0.9, 1.0}}, 5.0}};
  world.robots[0].energy = {0.5, 0.0, 1.0, 2.0, {"wind"}};
  TrialMetrics metrics(world, at_s(0.0));
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.trajectory.start_time = at_s(1.0);
  // Two steps along x at 1 m/s, the second from within the region "wind"; a turn; rest.
  plan.trajectory.segments = {{{1.0, 0.0}, 1.0, 0.0}, {{0.0, 1.0}, 0.5, 0.0}};
  metrics.on_plan(plan);
  plan.robot = "Q2";  // has no energy cost
  metrics.on_plan(plan);
  EXPECT_DOUBLE_EQ(metrics.finish(at_s(1.0)).energy_nats, 0.5 * (2.0 + (2.0 + 5.0) + 1.0));
}

TEST(TrialMetrics, DistinguishesCollisionsAndNearMisses) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  models::CollisionReport contact;
  contact.kind = models::CollisionKind::kNearMiss;
  metrics.on_contact(contact);
  metrics.on_contact(contact);
  contact.kind = models::CollisionKind::kCollision;
  metrics.on_contact(contact);
  const TrialSummary summary = metrics.finish(at_s(1.0));
  EXPECT_EQ(summary.collisions, 1);
  EXPECT_EQ(summary.separation_violations, 2);
}

TEST(TrialMetrics, SumsTheNewestLossCountersOfEachProcess) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  health.counters = {{"BELIEF_Q1.lost", 2}, {"VICON.lost", 1}, {"VICON.duplicates", 50}};
  metrics.on_health(health);
  health.counters[0].count = 3;
  metrics.on_health(health);
  health.process = "PLANNER_Q2";
  metrics.on_health(health);
  EXPECT_EQ(metrics.finish(at_s(1.0)).messages_lost, 8);
  EXPECT_EQ(metrics.finish(at_s(1.0), 5).messages_lost, 5);
}

TEST(TrialMetrics, KeepsTheLossOfAReplacedRun) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  models::ProcessHealth health;
  health.process = "PLANNER_Q1";
  health.stamp.run_id = 1;
  health.counters = {{"VICON.lost", 7}};
  metrics.on_health(health);
  health.stamp.run_id = 2;
  health.counters = {{"VICON.lost", 1}};
  metrics.on_health(health);
  EXPECT_EQ(metrics.messages_lost(), 8);
}

TEST(TrialSummary, HasThePublishedKeysFirstAndInOrder) {
  const nlohmann::ordered_json json =
      to_json(TrialMetrics(scenario(), at_s(0.0)).finish(at_s(2.0)));
  const std::vector<std::string> published = {"seed",
                                              "duration_s",
                                              "collisions",
                                              "separation_violations",
                                              "min_separation_m",
                                              "discovered",
                                              "targets",
                                              "discovery_time_s",
                                              "rmse_m",
                                              "entropy",
                                              "rounds",
                                              "rounds_late",
                                              "fallbacks",
                                              "messages_lost"};
  auto entry = json.begin();
  for (const std::string& key : published) {
    ASSERT_NE(entry, json.end());
    EXPECT_EQ(entry.key(), key);
    ++entry;
  }
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["targets"], 2);
  EXPECT_EQ(json["discovery_time_s"].size(), 2U);
  EXPECT_TRUE(json["discovery_time_s"][0].is_null());
  EXPECT_TRUE(json["rmse_m"].is_null());
  EXPECT_TRUE(json["min_separation_m"].is_null());
  EXPECT_TRUE(json["entropy"].is_number());
}

TEST(TrialMetrics, IgnoresBeliefsThatArriveAfterTheirStepWasEvaluated) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  metrics.on_truth(truth(0.0));
  metrics.on_truth(truth(5.0));
  metrics.on_belief(belief("Q1", 0.5, {target(1, 5.0, 6.0, 1.0)}));
  metrics.on_belief(belief("Q1", 1.0, {target(1, 5.0, 6.0, 1.0)}));
  metrics.on_belief(belief("Q2", 0.5, {target(1, 5.0, 5.0, 0.1)}));  // in time for step 0.5 s
  metrics.on_belief(belief("Q1", 1.5, {target(1, 5.0, 6.0, 1.0)}));  // evaluates step 0.5 s
  EXPECT_NEAR(metrics.targets()[1].error_m.value(), 0.0, 1e-9);
  EXPECT_EQ(metrics.targets()[1].estimate->robot, "Q2");
  metrics.on_belief(belief("Q2", 0.5, {target(0, 9.0, 9.0, 0.1)}));  // too late for step 0.5 s
  const TrialSummary summary = metrics.finish(at_s(5.0));
  EXPECT_NEAR(*summary.rmse_m, (0.0 + 1.0 + 1.0) / 3.0, 1e-9);
  EXPECT_EQ(summary.discovery_time_s[0], 0.5) << "but it was published in time";
  EXPECT_EQ(metrics.finish(at_s(5.0)).rmse_m, summary.rmse_m) << "nothing is evaluated twice";
}

TEST(TrialMetrics, CountsDuplicatePlansOnce) {
  scenario::Scenario named = scenario();
  named.planner.algorithm = "greedy";
  TrialMetrics metrics(named, at_s(0.5));
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.round = 4;
  for (int time = 0; time < 3; ++time) {
    metrics.on_plan(plan);
  }
  EXPECT_EQ(metrics.robots().at("Q1").plan->round, 4);
  EXPECT_FALSE(metrics.robots().at("Q2").plan);
  models::VehicleStatus status;
  status.robot = "Q2";
  status.state = models::FlightState::kLand;
  metrics.on_vehicle(status);
  EXPECT_EQ(metrics.robots().at("Q2").state, models::FlightState::kLand);
  EXPECT_FALSE(metrics.robots().at("Q1").state);
  metrics.on_belief(belief("Q1", 1.0, {target(-1, 0.0, 0.0, 1.0), target(2, 0.0, 0.0, 1.0)}));
  const TrialSummary summary = metrics.finish(at_s(3.0));
  EXPECT_EQ(summary.plans_missing, 0);
  EXPECT_EQ(summary.plans, 3);
  EXPECT_EQ(summary.rounds, 1);
  EXPECT_EQ(summary.duration_s, 2.5);
  EXPECT_EQ(summary.scenario, "bench");
  EXPECT_EQ(summary.algorithm, "greedy");
  EXPECT_EQ(summary.discovered, 0) << "these targets do not exist";
  EXPECT_EQ(summary.undiscovered_share, 1.0);
  EXPECT_EQ(metrics.position_dim(), 2);
  EXPECT_FALSE(summary.map_entropy_nats);
}

TEST(TrialMetrics, AveragesTheEntropyOfTheNewestMaps) {
  TrialMetrics metrics(scenario(), at_s(0.0));
  models::RobotMap map;
  for (const auto& [robot, nats] : {std::pair{"Q1", 100.0}, {"Q2", 30.0}, {"Q1", 10.0}}) {
    map.robot = robot;
    map.entropy_nats = nats;
    metrics.on_map(map);
  }
  EXPECT_EQ(metrics.map_entropy_nats(), 20.0);
  EXPECT_EQ(metrics.finish(at_s(1.0)).map_entropy_nats, 20.0);
}

TEST(TrialMetrics, EqualThePriorWithoutMessages) {
  const TrialSummary summary = TrialMetrics(scenario(), at_s(0.0)).finish(at_s(2.0));
  const double prior = isotropic_entropy_nats(kPriorSigma_m, 2);
  EXPECT_EQ(summary.undiscovered_share, 1.0);
  EXPECT_NEAR(summary.entropy_nats, prior, 1e-12);
  EXPECT_EQ(summary.entropy_per_target_nats.size(), 2U);
  EXPECT_NEAR(summary.entropy_per_target_nats[1], prior, 1e-12);
  EXPECT_EQ(summary.plans_missing, 0);
  scenario::Scenario alone = scenario();
  alone.targets.clear();
  TrialMetrics without(alone, at_s(0.0));
  without.on_belief(belief("Q1", 1.0, {}));
  EXPECT_EQ(without.finish(at_s(2.0)).entropy_nats, 0.0);
  EXPECT_EQ(without.finish(at_s(2.0)).undiscovered_share, 0.0);
}

}  // namespace
}  // namespace vantage::logs
