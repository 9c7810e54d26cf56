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

/// Means over the robots of a trial, where each robot is evaluated by its own belief alone. Figures
/// 3.3 and 4.3 of the dissertation plot these values. (The rest of a TrialSummary evaluates the
/// team: the best informed robot at each step.)
struct RobotMeans {
  /// Mean over time of the position RMSE of the robot's known targets.
  std::optional<double> rmse_m;
  /// Mean over time and targets; an unknown target has the entropy of its prior.
  double entropy_nats = 0.0;
  double discovered = 0.0;  ///< mean number of targets that a robot has ever known
  /// Mean time until a robot knows a target; the trial's duration if the robot never knows it.
  double discovery_time_s = 0.0;
  /// Mean over time of the share of targets that a robot does not know.
  double undiscovered_share = 0.0;
  /// Consistency of all robots' position estimates of their known targets, taken together.
  Consistency consistency;
  std::array<Consistency, kAgeClasses> consistency_by_age;  ///< by age class (kAgeEdges_s)
};

/// One estimator step, where each robot is evaluated by its own belief alone.
class RobotStep {
 public:
  struct Nees {
    std::int64_t samples = 0;
    double sum = 0.0;
  };

  /// Adds one robot. `rmse_m` is over the targets with known truth; nullopt if there are none.
  void add(double entropy_nats, std::optional<double> rmse_m);
  void add_nees(std::size_t age_class, double nees);

  /// Return the means over the robots; nullopt if there are no values.
  [[nodiscard]] std::optional<double> entropy_nats() const;
  [[nodiscard]] std::optional<double> rmse_m() const;
  /// Returns the NEES by the time since the target was last seen; see kAgeEdges_s.
  [[nodiscard]] const std::array<Nees, kAgeClasses>& nees_by_age() const { return nees_by_age_; }

 private:
  int robots_ = 0;
  int robots_with_error_ = 0;
  double entropy_sum_nats_ = 0.0;
  double rmse_sum_m_ = 0.0;
  std::array<Nees, kAgeClasses> nees_by_age_;
};

/// Accumulator that computes RobotMeans from all steps.
class RobotSums {
 public:
  RobotSums(int targets, int position_dim, double prior_entropy_nats);

  /// Adds the belief of one robot at one step, also to `step`. `since_start_s` is the time since
  /// the start of the trial. Targets without truth at that time count only for the entropy.
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
    std::vector<std::optional<double>> first_known_s;  ///< s; start of knowledge, by target id
  };

  int targets_ = 0;
  int position_dim_ = 2;
  double prior_entropy_nats_ = 0.0;
  std::map<std::string, Sums> robots_;
  NeesSums nees_;
  std::vector<NeesSums> nees_by_age_;
};

}  // namespace vantage::logs
