#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "logs/metrics/pose_means.hpp"
#include "logs/metrics/robot_means.hpp"

namespace vantage::logs {

/// Results of one trial. Means are over all estimator steps of the trial.
struct TrialSummary {
  std::uint64_t seed = 0;
  double duration_s = 0.0;
  std::int64_t collisions = 0;
  std::int64_t separation_violations = 0;  ///< near misses reported by the simulator
  /// Minimum distance between the centres of two robots, m; nullopt with one robot.
  std::optional<double> min_separation_m;
  int discovered = 0;  ///< number of targets that any robot has discovered
  int targets = 0;
  std::vector<std::optional<double>> discovery_time_s;  ///< s, by target id; nullopt: never
  std::optional<double> rmse_m;  ///< m; mean over time of the known targets' position RMSE
  /// Mean over time and targets; an unknown target has the entropy of its prior.
  double entropy_nats = 0.0;
  std::int64_t rounds = 0;       ///< planning rounds in which some robot published a plan
  std::int64_t rounds_late = 0;  ///< rounds in which some plan was finished after its deadline
  /// number of plans that were not found by a search in the robot's own slot
  std::int64_t fallbacks = 0;
  std::int64_t messages_lost = 0;

  std::string scenario;
  std::string algorithm;
  std::int64_t plans = 0;
  std::int64_t plans_missing = 0;  ///< number of missing plans: rounds · robots − plans
  /// Energy cost of the planned motion of all robots (models/scenario). Each plan counts until the
  /// next plan begins.
  double energy_nats = 0.0;
  double undiscovered_share = 0.0;  ///< mean over time of the share of targets that no robot knows
  /// RMSE over the time in which the target was known, m.
  std::vector<std::optional<double>> rmse_per_target_m;
  std::vector<double> entropy_per_target_nats;
  /// Mean NEES eᵀ Σ⁻¹ e of the position estimates that the RMSE uses: the number of coordinates if
  /// the estimator is consistent, more if it is overconfident. At each step the most certain robot
  /// is used, which selects overconfident estimates. Therefore this value is above
  /// per_robot.consistency, which characterises the filter.
  std::optional<double> position_nees;
  /// Mean entropy of the robots' last maps; nullopt if no robot maps.
  std::optional<double> map_entropy_nats;
  PoseMeans poses;       ///< errors of the robots' own poses without motion capture
  RobotMeans per_robot;  ///< each robot evaluated by its own belief; mean over the robots
};

/// Returns the summary as JSON: the keys of the published table in their published order, then
/// additional keys; absent values are null. Equal summaries give equal text.
nlohmann::ordered_json to_json(const TrialSummary& summary);

}  // namespace vantage::logs
