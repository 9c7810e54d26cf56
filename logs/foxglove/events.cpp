#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "logs/foxglove/values.hpp"

namespace vantage::logs::foxglove {
namespace {

std::string reasons_of(const models::VehicleStatus& status) {
  return status.reasons.empty() ? "" : fmt::format(": {}", fmt::join(status.reasons, ", "));
}

}  // namespace

Event event_of(const models::CollisionReport& contact) {
  const bool is_collision = contact.kind == models::CollisionKind::kCollision;
  return {contact.stamp.time, is_collision ? LogLevel::kFatal : LogLevel::kWarning,
          is_collision ? "collision" : "near_miss",
          fmt::format("{} and {} {} ({:.2f} m)", contact.body_a, contact.body_b,
                      is_collision ? "collided" : "came too close", contact.distance_m)};
}

std::optional<Event> event_of(const models::RobotPlan& plan) {
  if (plan.late) {
    return Event{
        plan.finish, LogLevel::kWarning, "late",
        fmt::format("{}: plan of round {} was {:.1f} ms late", plan.robot,
                    models::round_text(plan.round), 1e3 * to_seconds(plan.finish - plan.deadline))};
  }
  if (plan.source != models::PlanSource::kSearched) {
    return Event{plan.finish, LogLevel::kWarning, "fallback",
                 fmt::format("{}: plan of round {} is {}", plan.robot,
                             models::round_text(plan.round), name_of(plan.source))};
  }
  return std::nullopt;
}

std::optional<Event> event_of(const models::VehicleStatus* before,
                              const models::VehicleStatus& status) {
  const bool is_calm = status.reasons.empty() && (status.state == models::FlightState::kIdle ||
                                                  status.state == models::FlightState::kFollow);
  if (before == nullptr ? is_calm
                        : before->state == status.state && before->reasons == status.reasons) {
    return std::nullopt;
  }
  const bool is_killed = status.state == models::FlightState::kKilled;
  return Event{status.stamp.time,
               is_killed ? LogLevel::kError
               : is_calm ? LogLevel::kInfo
                         : LogLevel::kWarning,
               "safety",
               fmt::format("{}: {}{}", status.robot, name_of(status.state), reasons_of(status))};
}

std::optional<Event> event_of(const models::AttackNotice* before,
                              const models::AttackNotice& attack) {
  std::vector<std::string> jammed = attack.jammed;
  std::vector<std::string> known = before == nullptr ? std::vector<std::string>{} : before->jammed;
  std::sort(jammed.begin(), jammed.end());
  std::sort(known.begin(), known.end());
  if (jammed == known) {
    return std::nullopt;
  }
  return Event{attack.stamp.time, jammed.empty() ? LogLevel::kInfo : LogLevel::kWarning, "attack",
               jammed.empty() ? std::string("no sensor is jammed anymore")
                              : fmt::format("jammed: {}", fmt::join(jammed, ", "))};
}

std::optional<Event> HealthStory::on(const models::ProcessHealth& health) {
  const auto event = [&](LogLevel level, const std::string& what) {
    return Event{health.stamp.time, level, "health", health.process + ": " + what};
  };
  const std::optional<models::ProcessHealth> before = std::exchange(last_, health);
  if (before && before->stamp.run_id != health.stamp.run_id) {
    degraded_.reset();
    return event(LogLevel::kWarning, "was restarted");
  }
  const Time now = health.stamp.time;
  if (health.state == models::ProcessState::kDegraded) {
    if (degraded_) {
      degraded_->second = now;
      return std::nullopt;
    }
    degraded_ = {now, now};
    return event(LogLevel::kWarning, "degraded: drops, missed deadlines or other errors");
  }
  if (health.state == models::ProcessState::kStopping) {
    degraded_.reset();
    return before && before->state == health.state
               ? std::nullopt
               : std::optional(event(LogLevel::kInfo, "is stopping"));
  }
  if (!degraded_ || now - degraded_->second < kWell) {
    return std::nullopt;
  }
  const double lasted_s = to_seconds(degraded_->second - degraded_->first);
  degraded_.reset();
  return event(LogLevel::kInfo,
               lasted_s > 0.0 ? fmt::format("recovered after {:.0f} s", lasted_s) : "recovered");
}

std::optional<Event> event_of(const models::HostReport* before, const models::HostReport& report) {
  const auto is_given_up = [](const models::SupervisedProcess& process) {
    return process.phase == models::SupervisedPhase::kGivenUp;
  };
  for (const models::SupervisedProcess& process : report.processes) {
    const bool was_known =
        before != nullptr &&
        std::any_of(before->processes.begin(), before->processes.end(), [&](const auto& known) {
          return known.name == process.name && is_given_up(known);
        });
    if (is_given_up(process) && !was_known) {
      return Event{report.stamp.time, LogLevel::kError, "health",
                   fmt::format("{} on {} is no longer restarted ({})", process.name, report.host,
                               process.last_end)};
    }
  }
  return std::nullopt;
}

}  // namespace vantage::logs::foxglove
