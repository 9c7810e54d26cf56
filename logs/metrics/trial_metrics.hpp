#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/pose_means.hpp"
#include "logs/metrics/run_set.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "logs/metrics/truth_history.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// State of one target at the newest evaluated step.
struct TargetStatus {
  std::string name;
  std::optional<double> discovered_s;  ///< s; time of discovery since the start of the trial
  std::string discovered_by;  ///< robot that first had a belief of the target; empty if none had
  /// The team's estimate; nullopt while no robot knows the target.
  std::optional<PositionEstimate> estimate;
  /// m; distance of the estimate from the true position at the estimate's time.
  std::optional<double> error_m;
  /// nats; entropy of the scenario's prior while no robot knows the target
  double entropy_nats = 0.0;
};

/// Newest messages of one robot.
struct RobotStatus {
  std::optional<models::FlightState> state;
  std::optional<models::RobotPlan> plan;
};

/// Evaluation of a trial from its messages. It has no side effects; messages are added one at a
/// time in order of arrival. Beliefs are grouped by estimator step. A step is evaluated two steps
/// later, when the truth around the step and the other robots' beliefs have arrived. If the sensors
/// report no ids, assign_ids_by_position() assigns each track to a target; the target counts as
/// discovered if the track is within 1 m of it.
class TrialMetrics {
 public:
  TrialMetrics(const scenario::Scenario& scenario, Time start);

  void on_truth(const models::TruthFrame& frame);
  void on_belief(const models::RobotBelief& belief);
  void on_pose(const models::PoseEstimate& estimate) { poses_.on_pose(estimate); }
  void on_map(const models::RobotMap& map);
  void on_plan(const models::RobotPlan& plan);
  void on_contact(const models::CollisionReport& contact);
  void on_vehicle(const models::VehicleStatus& status);
  /// Counts the messages that a process reports as lost: its newest counters with names that end in
  /// ".lost". They are summed over the runs of a process, because a restarted process counts from
  /// 0.
  void on_health(const models::ProcessHealth& health);

  /// Evaluates the pending steps and returns the summary. `messages_lost` replaces the count from
  /// HEALTH, for callers that can query every bus themselves.
  TrialSummary finish(Time end, std::optional<std::int64_t> messages_lost = std::nullopt);

  [[nodiscard]] const std::vector<TargetStatus>& targets() const { return targets_; }
  [[nodiscard]] const std::map<std::string, RobotStatus>& robots() const { return robots_; }
  /// Returns the newest evaluated step, with each robot evaluated by its own belief.
  [[nodiscard]] const RobotStep& step_of_robots() const { return step_of_robots_; }
  /// Returns the number of position coordinates n: the mean NEES of a consistent estimator.
  [[nodiscard]] int position_dim() const { return position_dim_; }
  /// Returns the mean entropy of the robots' newest maps; nullopt if no robot maps.
  [[nodiscard]] std::optional<double> map_entropy_nats() const;
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }
  [[nodiscard]] std::int64_t separation_violations() const { return separation_violations_; }
  [[nodiscard]] std::int64_t rounds() const { return rounds_.size(); }
  [[nodiscard]] std::int64_t rounds_late() const { return rounds_late_.size(); }
  [[nodiscard]] std::int64_t messages_lost() const;

 private:
  struct ReceivedBelief {
    Time time{};
    std::vector<models::TargetBelief> targets;
  };
  using Step = std::map<std::string, ReceivedBelief>;  ///< by robot
  struct TargetSums {
    double squared_error_m2 = 0.0;
    std::int64_t errors = 0;
    double entropy_nats = 0.0;
  };

  void judge(const Step& step);
  void judge_targets(const TeamEstimate& team);
  void discover(int target_id, const std::string& robot, Time time);
  /// Returns the tracks with target ids instead of labels, and marks the targets as discovered.
  [[nodiscard]] std::vector<models::TargetBelief> named(const std::string& robot,
                                                        const ReceivedBelief& received);

  /// Returns the energy cost, nats, of the steps of `plan` that are executed before the next plan.
  [[nodiscard]] double energy_nats(const models::RobotPlan& plan) const;

  const models::World world_;
  const std::vector<scenario::RobotSpec> specs_;
  const int execute_steps_;
  const Time start_;
  const std::int64_t step_us_;
  const int position_dim_;
  const double prior_entropy_nats_;
  const bool has_ids_;    ///< true if detections and beliefs contain target ids
  TrialSummary summary_;  ///< values known from the start: names, seed, sizes

  TruthHistory truth_;
  PoseSums poses_;
  std::map<std::int64_t, Step> pending_;  ///< steps not yet evaluated, by step index
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
  std::map<std::string, double> map_entropies_nats_;  ///< nats; entropy of each robot's newest map
  /// number of lost messages, by process and run id
  std::map<std::pair<std::string, std::int64_t>, std::int64_t> lost_;
};

}  // namespace vantage::logs
