#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/run_set.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/metrics/truth_history.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// One target, as of the newest step that has been judged.
struct TargetStatus {
  std::string name;
  std::optional<double> discovered_s;        ///< since the trial's start
  std::optional<PositionEstimate> estimate;  ///< the team's; none while nobody knows it
  std::optional<double> error_m;             ///< of the estimate against the truth at its own time
  double entropy_nats = 0.0;                 ///< of the stated prior while nobody knows it
};

/// One robot, as last heard.
struct RobotStatus {
  std::optional<models::FlightState> state;
  std::optional<models::RobotPlan> plan;
};

/// Judges a trial from the messages that travelled in it: pure, fed one message at a time, in the
/// order of arrival. Beliefs are gathered by estimator step and judged one step late, when the
/// truth around them and the other robots' beliefs of the same step have come. Of a team whose
/// sensors tell no ids a track is judged as the target that named_by_place() takes it for, and a
/// target is discovered when that is nearer than 1 m.
class TrialMetrics {
 public:
  TrialMetrics(const scenario::Scenario& scenario, Time start);

  void on_truth(const models::TruthFrame& frame);
  void on_belief(const models::RobotBelief& belief);
  void on_map(const models::RobotMap& map);
  void on_plan(const models::RobotPlan& plan);
  void on_contact(const models::ContactReport& contact);
  void on_vehicle(const models::VehicleStatus& status);
  /// Messages that a process reports lost: its newest counters whose name ends in ".lost", added up
  /// over its runs: a process that was started again counts from 0.
  void on_health(const models::ProcessHealth& health);

  /// Judges what is still pending and sums up. `messages_lost` overrides what HEALTH said, for
  /// callers that can ask every bus themselves.
  TrialSummary finish(Time end, std::optional<std::int64_t> messages_lost = std::nullopt);

  [[nodiscard]] const std::vector<TargetStatus>& targets() const { return targets_; }
  [[nodiscard]] const std::map<std::string, RobotStatus>& robots() const { return robots_; }
  /// The newest step that has been judged, as its robots saw it.
  [[nodiscard]] const RobotStep& step_of_robots() const { return step_of_robots_; }
  /// n of a position's coordinates: the mean NEES of an estimator that knows how wrong it is.
  [[nodiscard]] int position_dim() const { return position_dim_; }
  /// Mean over the robots' newest maps; none where nobody maps.
  [[nodiscard]] std::optional<double> map_entropy_nats() const;
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }
  [[nodiscard]] std::int64_t separation_violations() const { return separation_violations_; }
  [[nodiscard]] std::int64_t rounds() const { return rounds_.size(); }
  [[nodiscard]] std::int64_t rounds_late() const { return rounds_late_.size(); }
  [[nodiscard]] std::int64_t messages_lost() const;

 private:
  struct Heard {
    Time time{};
    std::vector<models::TargetBelief> targets;
  };
  using Step = std::map<std::string, Heard>;  ///< by robot
  struct TargetSums {
    double squared_error_m2 = 0.0;
    std::int64_t errors = 0;
    double entropy_nats = 0.0;
  };

  void judge(const Step& step);
  void judge_targets(const TeamEstimate& team);
  void discover(int target_id, Time time);
  /// Ids in the place of labels, and what they have discovered.
  [[nodiscard]] std::vector<models::TargetBelief> named(const Heard& heard);

  /// What the steps of `plan` until the next one cost, priced.
  [[nodiscard]] double energy_nats(const models::RobotPlan& plan) const;

  const models::World world_;
  const std::vector<scenario::RobotSpec> specs_;
  const int execute_steps_;
  const Time start_;
  const std::int64_t step_us_;
  const int position_dim_;
  const double prior_entropy_nats_;
  const bool has_ids_;    ///< detections bear ids, beliefs too
  TrialSummary summary_;  ///< what is known from the start: names, seed, sizes

  TruthHistory truth_;
  std::map<std::int64_t, Step> pending_;  ///< by step index
  std::int64_t newest_judged_ = -1;
  std::vector<TargetStatus> targets_;
  std::vector<TargetSums> sums_;
  RobotSums robot_sums_;
  RobotStep step_of_robots_;
  std::map<std::string, RobotStatus> robots_;
  std::int64_t steps_ = 0;
  std::int64_t steps_with_error_ = 0;
  double rmse_sum_m_ = 0.0;
  double nees_sum_ = 0.0;
  double unknown_share_sum_ = 0.0;

  std::int64_t collisions_ = 0;
  std::int64_t separation_violations_ = 0;
  RunSet rounds_;
  RunSet rounds_late_;
  std::int64_t plans_ = 0;
  std::int64_t fallbacks_ = 0;
  std::map<std::string, double> map_entropies_nats_;                   ///< newest, by robot
  std::map<std::pair<std::string, std::int64_t>, std::int64_t> lost_;  ///< by process and run
};

}  // namespace vantage::logs
