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

/// One step as its robots saw it, each judged by its own belief alone.
class RobotStep {
 public:
  struct Nees {
    std::int64_t samples = 0;
    double sum = 0.0;
  };

  /// One robot. `rmse_m` of the targets whose truth is known, if any.
  void add(double entropy_nats, std::optional<double> rmse_m);
  void add_nees(std::size_t age_class, double nees);

  /// Means over the robots; nullopt without any.
  [[nodiscard]] std::optional<double> entropy_nats() const;
  [[nodiscard]] std::optional<double> rmse_m() const;
  /// By how long ago the target was last seen; see kAgeEdges_s.
  [[nodiscard]] const std::array<Nees, kAgeClasses>& nees_by_age() const { return nees_by_age_; }

 private:
  int robots_ = 0;
  int robots_with_error_ = 0;
  double entropy_sum_nats_ = 0.0;
  double rmse_sum_m_ = 0.0;
  std::array<Nees, kAgeClasses> nees_by_age_;
};

/// Gathers RobotMeans step by step.
class RobotSums {
 public:
  RobotSums(int targets, int position_dim, double prior_entropy_nats);

  /// One robot's belief of one step, which is added to `step` as well. `since_start_s` is the
  /// belief's time in the trial. Targets without truth at that time count for the entropy only.
  void add(const std::string& robot, Time time, double since_start_s,
           std::span<const models::TargetBelief> beliefs, const TruthHistory& truth,
           RobotStep& step);
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
