#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/foxglove/parts.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

// Conversion of messages to foxglove.FrameTransforms, foxglove.Grid, foxglove.Log and vantage.*.
// Free of side effects. Non-finite numbers (no cost, no proven bound) are left out because JSON
// cannot represent them.

namespace vantage::logs::foxglove {

/// Returns world_from_body of every visible body; child frames have the names of the bodies.
Json frame_transforms(const models::MocapFrame& frame);
/// Returns the true poses of all bodies from the simulator. `prefix` is prepended to each name.
Json frame_transforms(const models::TruthFrame& truth, const std::string& prefix);

/// Returns the time since any robot saw each cell, as of `time`: one f32 field "age_s" in s, −1 for
/// never. Precondition: `last_seen_utime` has grid.size() entries.
Json visibility_grid(const models::GridGeometry& grid,
                     const std::vector<std::int64_t>& last_seen_utime, Time time);

/// Returns the occupancy probability of each cell in `map`: one f32 field "occupancy"; 0 or 1 for
/// settled cells.
Json occupancy_grid(const models::RobotMap& map, const models::MappingSpec& spec);

/// Returns a vantage.Scenario. `session` identifies the run of the trial: the publisher's run id.
Json scenario_json(const models::ScenarioNotice& notice, const scenario::Scenario& scenario);
/// Returns a vantage.Plan: margin_s = deadline − finish, gap_nat = cost − lower bound.
Json plan_json(const models::RobotPlan& plan);
/// Returns a vantage.Vehicle. `capture_to_setpoint`: time from the capture of the newest
/// measurement that the followed plan is based on until the vehicle followed the plan; nullopt if
/// unknown.
Json vehicle_json(const models::VehicleStatus& status,
                  std::optional<Duration> capture_to_setpoint = std::nullopt);
/// Returns a vantage.Health: messages_lost sums the counters that end in ".lost".
Json health_json(const models::ProcessHealth& health);
/// Returns a vantage.Attack.
Json attack_json(const models::AttackNotice& attack);

/// Returns a vantage.Team: the quality of the team's estimates at the newest evaluated step. The
/// RMSE is over the known targets with truth; it is absent if there are none. The members robot_…
/// are means over the robots, each evaluated by its own belief alone. nees_by_age is the NEES by
/// the time since a target was last seen; its expected mean is nees_expected if the estimators are
/// consistent.
Json team_json(const TrialMetrics& metrics, Time time);

/// Severity of a foxglove.Log.
enum class LogLevel { kDebug = 1, kInfo = 2, kWarning = 3, kError = 4, kFatal = 5 };

/// Event to be marked on a time line.
struct Event {
  Time time{};
  LogLevel level = LogLevel::kInfo;
  /// collision, near_miss, late, fallback, attack, safety, health, scenario, two_publishers, found,
  /// lost
  std::string kind;
  std::string text;
};

/// Returns a foxglove.Log; the event's kind is in `name`.
Json log_json(const Event& event);

Event event_of(const models::CollisionReport& contact);
/// Returns the event of a late plan or a fallback; nullopt for a plan that was searched in time.
std::optional<Event> event_of(const models::RobotPlan& plan);
/// Returns the event of a change of a vehicle's state; nullopt without a change, or if the first
/// received status is normal.
std::optional<Event> event_of(const models::VehicleStatus* before,
                              const models::VehicleStatus& status);
std::optional<Event> event_of(const models::AttackNotice* before,
                              const models::AttackNotice& attack);
/// Returns the event of the first process that its supervisor has given up since `before`.
std::optional<Event> event_of(const models::HostReport* before, const models::HostReport& report);

/// Detector of events in one process's health: stopped, restarted, degraded, recovered. A degraded
/// report is an event only if something was lost: counters that change in normal operation do not
/// count (bus::is_normal_counter). On a loaded machine a process may alternate between degraded and
/// healthy each second. Such alternation counts as one degraded period, which ends after the
/// process has been healthy for kWell.
class HealthStory {
 public:
  static constexpr Duration kWell = std::chrono::seconds(5);

  std::optional<Event> on(const models::ProcessHealth& health);

 private:
  std::optional<models::ProcessHealth> last_;
  /// Start of a degraded period that has not ended, and the time of its newest degraded report.
  std::optional<std::pair<Time, Time>> degraded_;
};

/// Last measurement of one target, from sensors that report ids.
struct Sighting {
  std::string robot;
  Time time{};
};

/// Judgement of a target's state from its estimates: sought until it is found, then known or lost.
/// A found target is lost if no robot has an estimate, or if the best estimate is as uncertain as
/// that of an undiscovered target. A lost target is known again when its entropy has fallen by
/// kRegain_nats below that limit.
class TargetStory {
 public:
  static constexpr double kRegain_nats = 0.5;
  enum class State { kSought, kKnown, kLost };

  explicit TargetStory(double prior_entropy_nats) : prior_nats_(prior_entropy_nats) {}
  /// Returns the event of a discovery, loss or new sighting; nullopt if the state is unchanged.
  /// @param seen_by  the robot that last measured the target; empty if unknown
  std::optional<Event> on(const TargetStatus& target, const std::string& seen_by, Time time);
  [[nodiscard]] State state() const { return state_; }

 private:
  double prior_nats_;
  State state_ = State::kSought;
  bool has_estimate_ = false;  ///< an estimate better than the prior was evaluated
};

/// Returns "sought", "known" or "lost".
const char* name_of(TargetStory::State state);

/// Returns a vantage.Targets: one entry per target of `metrics`, in their order. found_s counts
/// from the start of `metrics`; a target that was found less than `unknown_until_s` after this
/// start has no found_s and no found_by, because it may have been found before. unseen_s is the
/// time from the last measurement to the estimate. Preconditions: `stories` has one entry per
/// target.
Json targets_json(const TrialMetrics& metrics, const std::vector<TargetStory>& stories,
                  const std::map<int, Sighting>& sightings, double unknown_until_s, Time time);

}  // namespace vantage::logs::foxglove
