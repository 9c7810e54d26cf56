#include "logs/metrics/consistency.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "logs/metrics/robot_means.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/metrics/truth_history.hpp"

namespace vantage::logs {
namespace {

// The samples are log-uniform; their median is at different positions within a histogram bin.
TEST(NeesSums, ReportsTheMedian) {
  for (const double from : {-3.9, -0.5, 0.0, 2.123}) {
    for (const double length : {0.343, 0.6868, 1.7772}) {
      NeesSums sums(2);
      constexpr int kSamples = 20'000;
      for (int i = 0; i < kSamples; ++i) {
        sums.add(std::pow(10.0, from + length * (i + 0.5) / kSamples));
      }
      const double median = std::pow(10.0, from + 0.5 * length);
      EXPECT_NEAR(sums.result().median_nees.value() / median, 1.0, 2e-4) << from << " " << length;
    }
  }
}

TEST(NeesSums, CountsEstimatesInsideTheEllipse) {
  // Limits of the 95 % ellipse from tables of chi squared: 5.991 for 2 coordinates, 7.815 for 3.
  for (const auto& [dim, edge] : {std::pair{2, 5.991}, {3, 7.815}}) {
    NeesSums sums(dim);
    sums.add(edge - 0.002);
    EXPECT_EQ(sums.result().coverage_95, 1.0);
    sums.add(edge + 0.002);
    sums.add(1e9);
    sums.add(0.0);
    EXPECT_EQ(sums.result().coverage_95, 0.5);
    EXPECT_EQ(sums.result().samples, 4);
  }
  const Consistency none = NeesSums(2).result();
  EXPECT_EQ(none.samples, 0);
  EXPECT_FALSE(none.mean_nees);
  EXPECT_FALSE(none.coverage_95);
}

TEST(NeesSums, CountsExtremeValuesInTheOutermostBins) {
  for (const double nees : {0.0, 1e-300, 1e-5}) {
    NeesSums sums(2);
    sums.add(nees);
    EXPECT_NEAR(*sums.result().median_nees, 1e-4, 0.02e-4);
  }
  for (const double nees : {1e7, 1e300}) {
    NeesSums sums(2);
    sums.add(nees);
    EXPECT_NEAR(*sums.result().median_nees, 1e6, 0.02e6);
  }
}

TEST(AgeClass, HasTheStatedEdges) {
  const std::vector<std::string> names = {"0-1", "1-2", "2-4", "4-8", "8+"};
  const double edges_s[] = {0.0, 1.0, 2.0, 4.0, 8.0};
  ASSERT_EQ(kAgeClasses, names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(age_name(i), names[i]);
    EXPECT_EQ(age_class(edges_s[i]), i);
    EXPECT_EQ(age_class(std::nextafter(edges_s[i], -1.0)), i == 0 ? 0 : i - 1);
  }
}

models::TargetBelief known(int id, double x_m, double sigma_m) {
  models::TargetBelief out;
  out.target_id = id;
  out.information.matrix = Eigen::Matrix2d::Identity() / (sigma_m * sigma_m);
  out.information.vector = out.information.matrix * Eigen::Vector2d(x_m, 0.0);
  return out;
}

// Ids that do not belong to a target of the trial, and targets without information, are skipped.
TEST(RobotSums, IgnoreUnknownTargets) {
  models::TruthFrame frame;
  frame.stamp.time = from_utime(5);
  for (int id = -1; id <= 2; ++id) {
    frame.bodies.push_back({"R", id, {}, Eigen::Vector3d::Zero()});
  }
  TruthHistory truth;
  truth.add(frame);
  models::TargetBelief nothing = known(1, 0.0, 1.0);
  nothing.information.matrix.setZero();
  RobotSums sums(2, 2, 9.0);
  RobotStep step;
  sums.add("Q1", from_utime(5), 3.0,
           std::vector{known(-1, 7.0, 1.0), known(0, 3.0, 1.0), nothing, known(2, 7.0, 1.0)}, truth,
           step);
  const RobotMeans means = sums.means(10.0);
  const double nats = 0.5 * (isotropic_entropy_nats(1.0, 2) + 9.0);
  EXPECT_NEAR(means.rmse_m.value(), 3.0, 1e-9);
  EXPECT_NEAR(means.entropy_nats, nats, 1e-9);
  EXPECT_EQ(means.discovered, 1.0);
  EXPECT_EQ(means.discovery_time_s, 0.5 * (3.0 + 10.0));
  EXPECT_EQ(means.undiscovered_share, 0.5);
  EXPECT_EQ(means.consistency.samples, 1);
  EXPECT_NEAR(step.entropy_nats().value(), nats, 1e-9);
  EXPECT_NEAR(step.rmse_m().value(), 3.0, 1e-9);
  // A trial without targets has neither entropy nor errors.
  RobotSums without(0, 2, 9.0);
  RobotStep empty;
  without.add("Q1", from_utime(5), 3.0, {}, truth, empty);
  EXPECT_FALSE(empty.entropy_nats());
  EXPECT_FALSE(empty.rmse_m());
  EXPECT_EQ(without.means(10.0).entropy_nats, 0.0);
  EXPECT_EQ(RobotSums(2, 2, 9.0).means(10.0).entropy_nats, 0.0) << "without any robot";
}

Consistency consistency(double base) {
  return {static_cast<std::int64_t>(base), base + 0.25, base + 0.5, base + 0.75};
}

// Each number of a summary is written under its own key only.
TEST(TrialSummary, ContainsEachNumberByKey) {
  TrialSummary summary;
  summary.seed = 1;
  summary.duration_s = 2.5;
  summary.collisions = 3;
  summary.separation_violations = 4;
  summary.min_separation_m = 5.5;
  summary.discovered = 6;
  summary.targets = 7;
  summary.discovery_time_s = {8.5, std::nullopt};
  summary.rmse_m = 9.5;
  summary.entropy_nats = 10.5;
  summary.rounds = 11;
  summary.rounds_late = 12;
  summary.fallbacks = 13;
  summary.messages_lost = 14;
  summary.scenario = "fifteen";
  summary.algorithm = "sixteen";
  summary.plans = 17;
  summary.plans_missing = 18;
  summary.energy_nats = 19.5;
  summary.undiscovered_share = 20.5;
  summary.rmse_per_target_m = {std::nullopt, 21.5};
  summary.entropy_per_target_nats = {22.5, 23.5};
  summary.position_nees = 24.5;
  summary.map_entropy_nats = 25.5;
  summary.per_robot.rmse_m = 26.5;
  summary.per_robot.entropy_nats = 27.5;
  summary.per_robot.discovered = 28.5;
  summary.per_robot.discovery_time_s = 29.5;
  summary.per_robot.undiscovered_share = 30.5;
  summary.per_robot.consistency = consistency(31.0);
  for (std::size_t i = 0; i < kAgeClasses; ++i) {
    summary.per_robot.consistency_by_age[i] = consistency(40.0 + static_cast<double>(i));
  }
  const nlohmann::ordered_json wanted = nlohmann::ordered_json::parse(R"({
    "seed": 1, "duration_s": 2.5, "collisions": 3, "separation_violations": 4,
    "min_separation_m": 5.5, "discovered": 6, "targets": 7, "discovery_time_s": [8.5, null],
    "rmse_m": 9.5, "entropy": 10.5, "rounds": 11, "rounds_late": 12, "fallbacks": 13,
    "messages_lost": 14, "scenario": "fifteen", "algorithm": "sixteen", "plans": 17,
    "plans_missing": 18, "energy": 19.5, "undiscovered_share": 20.5,
    "rmse_per_target_m": [null, 21.5], "entropy_per_target": [22.5, 23.5], "position_nees": 24.5,
    "per_robot": {"rmse_m": 26.5, "entropy": 27.5, "discovered": 28.5, "discovery_time_s": 29.5,
      "undiscovered_share": 30.5,
      "nees": {"samples": 31, "mean": 31.25, "median": 31.5, "coverage_95": 31.75},
      "nees_by_age": [
        {"unseen_from_s": 0.0, "samples": 40, "mean": 40.25, "median": 40.5, "coverage_95": 40.75},
        {"unseen_from_s": 1.0, "samples": 41, "mean": 41.25, "median": 41.5, "coverage_95": 41.75},
        {"unseen_from_s": 2.0, "samples": 42, "mean": 42.25, "median": 42.5, "coverage_95": 42.75},
        {"unseen_from_s": 4.0, "samples": 43, "mean": 43.25, "median": 43.5, "coverage_95": 43.75},
        {"unseen_from_s": 8.0, "samples": 44, "mean": 44.25, "median": 44.5,
         "coverage_95": 44.75}]},
    "map_entropy": 25.5})");
  EXPECT_EQ(to_json(summary), wanted);
}

}  // namespace
}  // namespace vantage::logs
