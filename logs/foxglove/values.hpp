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

// Messages as foxglove.FrameTransforms, foxglove.Grid, foxglove.Log and vantage.*. Pure. A number
// that is not finite (no cost, nothing proven) is left out, since JSON has no word for it.

namespace vantage::logs::foxglove {

/// world_from_body of every body in sight; child frames have the bodies' names.
Json frame_transforms(const models::MocapFrame& frame);
/// The same of the simulator's truth; `prefix` comes before each name.
Json frame_transforms(const models::TruthFrame& truth, const std::string& prefix);

/// How long ago each cell was seen by anyone [s], one f32 field "age_s", −1 for never, as of
/// `time`. Precondition: grid.size() entries.
Json visibility_grid(const models::GridGeometry& grid,
                     const std::vector<std::int64_t>& last_seen_utime, Time time);

/// How likely each cell is occupied, as `map`'s robot knows it: one f32 field "occupancy", 0 and 1
/// where that is settled.
Json occupancy_grid(const models::RobotMap& map, const models::MappingSpec& spec);

/// vantage.Scenario.
Json scenario_json(const models::ScenarioNotice& notice, const scenario::Scenario& scenario);
/// vantage.Plan: margin_s = deadline − finish, gap_nat = cost − lower bound.
Json plan_json(const models::RobotPlan& plan);
/// vantage.Vehicle. `capture_to_setpoint`: from the capture of the newest measurement that the plan
/// it follows was made from until it followed that plan, where both are known.
Json vehicle_json(const models::VehicleStatus& status,
                  std::optional<Duration> capture_to_setpoint = std::nullopt);
/// vantage.Health: messages_lost sums the counters that end in ".lost".
Json health_json(const models::ProcessHealth& health);
/// vantage.Attack.
Json attack_json(const models::AttackNotice& attack);

/// How well the team knows its targets, as of the newest judged step: vantage.Team. The RMSE is
/// over the targets that somebody knows and whose truth is heard; absent without one. Beside the
/// team's, robot_… are means over the robots, each judged by its own belief alone, and nees_by_age
/// is how wrong they are by how long ago a target was last seen: nees_expected in the mean where
/// the estimators know how wrong they are.
Json team_json(const TrialMetrics& metrics, Time time);

/// Severity of a foxglove.Log.
enum class LogLevel { kDebug = 1, kInfo = 2, kWarning = 3, kError = 4, kFatal = 5 };

/// Something that happened, to be marked on a time line.
struct Event {
  Time time{};
  LogLevel level = LogLevel::kInfo;
  std::string kind;  ///< collision, near_miss, late, fallback, attack, safety, health, scenario
  std::string text;
};

/// foxglove.Log; the kind stands in `name`.
Json log_json(const Event& event);

Event event_of(const models::ContactReport& contact);
/// nullopt for a plan that was searched in time.
std::optional<Event> event_of(const models::RobotPlan& plan);
/// What changed; nullopt when nothing did, or when the first status heard is a calm one.
std::optional<Event> event_of(const models::VehicleStatus* before,
                              const models::VehicleStatus& status);
std::optional<Event> event_of(const models::AttackNotice* before,
                              const models::AttackNotice& attack);
/// The first process that its supervisor has given up since `before`.
std::optional<Event> event_of(const models::HostReport* before, const models::HostReport& report);

/// What there is to tell of one process: that it stops, was started anew, is degraded, runs well
/// again. On a loaded machine a process may be degraded and well by turns each second: that is one
/// stretch, which ends once it has run well for kWell.
class HealthStory {
 public:
  static constexpr Duration kWell = std::chrono::seconds(5);

  std::optional<Event> on(const models::ProcessHealth& health);

 private:
  std::optional<models::ProcessHealth> last_;
  std::optional<std::pair<Time, Time>> degraded_;  ///< from, and when last; of an open stretch
};

}  // namespace vantage::logs::foxglove
