#pragma once

#include <chrono>
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

/// Returns a vantage.Scenario.
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
  std::string kind;  ///< collision, near_miss, late, fallback, attack, safety, health, scenario,
                     ///< two_publishers
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

/// Detector of events in one process's health: stopped, restarted, degraded, recovered. On a loaded
/// machine a process may alternate between degraded and healthy each second. Such alternation
/// counts as one degraded period, which ends after the process has been healthy for kWell.
class HealthStory {
 public:
  static constexpr Duration kWell = std::chrono::seconds(5);

  std::optional<Event> on(const models::ProcessHealth& health);

 private:
  std::optional<models::ProcessHealth> last_;
  /// Start of a degraded period that has not ended, and the time of its newest degraded report.
  std::optional<std::pair<Time, Time>> degraded_;
};

}  // namespace vantage::logs::foxglove
