#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/consistency.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

class TruthHistory;

/// The trial as its robots saw it, each judged by its own belief alone; then the mean over the
/// robots. This is what the source's figures 3.3 and 4.3 plot. (The rest of a TrialSummary judges
/// the team: the best informed robot of each step.)
struct RobotMeans {
  std::optional<double> rmse_m;  ///< mean over time of the position RMSE of what a robot knows
  double entropy_nats = 0.0;     ///< mean over time and targets; unknown ones count their prior
  double discovered = 0.0;       ///< targets that a robot ever knew
  /// Mean time until a robot knows a target; the trial's length where it never did.
  double discovery_time_s = 0.0;
  double undiscovered_share = 0.0;  ///< mean over time of the share of targets a robot ignores
  /// Of every robot's position estimates of the targets it knows, pooled.
  Consistency consistency;
  std::array<Consistency, kAgeClasses> consistency_by_age;  ///< see kAgeEdges_s
};

/// Gathers RobotMeans step by step.
class RobotSums {
 public:
  RobotSums(int targets, int position_dim, double prior_entropy_nats);

  /// One robot's belief of one step. `since_start_s` is the belief's time in the trial. Targets
  /// without truth at that time count for the entropy only.
  void add(const std::string& robot, Time time, double since_start_s,
           std::span<const models::TargetBelief> beliefs, const TruthHistory& truth);
  [[nodiscard]] RobotMeans means(double duration_s) const;

 private:
  struct Sums {
    std::int64_t steps = 0;
    std::int64_t steps_with_error = 0;
    double rmse_m = 0.0;
    double entropy_nats = 0.0;
    double unknown_share = 0.0;
    std::vector<std::optional<double>> first_known_s;  ///< by target id
  };

  int targets_ = 0;
  int position_dim_ = 2;
  double prior_entropy_nats_ = 0.0;
  std::map<std::string, Sums> robots_;
  NeesSums nees_;
  std::vector<NeesSums> nees_by_age_;
};

}  // namespace vantage::logs
