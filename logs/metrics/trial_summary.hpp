#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "logs/metrics/robot_means.hpp"

namespace vantage::logs {

/// What one trial comes to. Means are over the estimator steps of the whole trial.
struct TrialSummary {
  std::uint64_t seed = 0;
  double duration_s = 0.0;
  std::int64_t collisions = 0;
  std::int64_t separation_violations = 0;  ///< near misses reported by the simulator
  std::optional<double> min_separation_m;  ///< between two robots' centres; none with one robot
  int discovered = 0;                      ///< targets that some belief ever held
  int targets = 0;
  std::vector<std::optional<double>> discovery_time_s;  ///< by target id; none: never
  std::optional<double> rmse_m;  ///< mean over time of the position RMSE of the known targets
  double entropy_nats = 0.0;     ///< mean over time and targets; unknown ones count their prior
  std::int64_t rounds = 0;       ///< planning rounds in which some robot published a plan
  std::int64_t rounds_late = 0;  ///< rounds in which some plan was finished after its deadline
  std::int64_t fallbacks = 0;    ///< plans that did not come from their own slot's search
  std::int64_t messages_lost = 0;

  std::string scenario;
  std::string algorithm;
  std::int64_t plans = 0;
  std::int64_t plans_missing = 0;  ///< rounds · robots − plans
  /// What the planned motion costs all robots until the next plan, priced (models/scenario).
  double energy_nats = 0.0;
  double undiscovered_share = 0.0;  ///< mean over time of the share of targets nobody knows
  std::vector<std::optional<double>> rmse_per_target_m;  ///< over the time it was known
  std::vector<double> entropy_per_target_nats;
  /// Mean over the same estimates as the RMSE of eᵀ Σ⁻¹ e of the position: the number of
  /// coordinates where the estimator knows how wrong it is, more where it is too sure. Of each
  /// step the robot that is surest is judged: that selects who is too sure, so this is above the
  /// robots' own figure, per_robot.consistency, which is what tells about the filter.
  std::optional<double> position_nees;
  /// Of the robots' last maps, mean over those that have one; none where nobody maps.
  std::optional<double> map_entropy_nats;
  RobotMeans per_robot;  ///< the same, each robot judged by its own belief; mean over the robots
};

/// The keys of the published table in their published order, then the additions; absent values
/// are null. Equal summaries give equal text.
nlohmann::ordered_json to_json(const TrialSummary& summary);

}  // namespace vantage::logs
