#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bus/node/normal_counters.hpp"
#include "logs/foxglove/values.hpp"

namespace vantage::logs::foxglove {
namespace {

std::string reasons_of(const models::VehicleStatus& status) {
  return status.reasons.empty() ? "" : fmt::format(": {}", fmt::join(status.reasons, ", "));
}

/// Returns the increases of counters from `before` to `now` as text, such as
/// "2 deadlines missed, 3 stale_beliefs"; empty if no count has grown; nullopt if only counters of
/// normal operation have grown.
std::optional<std::string> losses(const models::ProcessHealth& before,
                                  const models::ProcessHealth& now) {
  constexpr std::size_t kNamedMax = 3;
  std::vector<std::string> lost;
  bool has_normal = false;
  if (now.deadlines_missed > before.deadlines_missed) {
    lost.push_back(
        fmt::format("{} deadlines missed", now.deadlines_missed - before.deadlines_missed));
  }
  for (const models::NamedCount& counter : now.counters) {
    const auto known =
        std::find_if(before.counters.begin(), before.counters.end(),
                     [&](const models::NamedCount& each) { return each.name == counter.name; });
    const std::int64_t more = counter.count - (known == before.counters.end() ? 0 : known->count);
    if (more > 0 && bus::is_rejection(counter.name)) {
      has_normal = true;
    } else if (more > 0 && !bus::is_normal_counter(counter.name)) {
      lost.push_back(fmt::format("{} {}", more, counter.name));
    }
  }
  if (lost.empty()) {
    return has_normal ? std::nullopt : std::optional(std::string());
  }
  if (lost.size() > kNamedMax) {
    lost[kNamedMax] = fmt::format("{} more", lost.size() - kNamedMax);
    lost.resize(kNamedMax + 1);
  }
  return fmt::format("{}", fmt::join(lost, ", "));
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

std::optional<Event> TargetStory::on(const TargetStatus& target, const std::string& seen_by,
                                     Time time) {
  const auto event = [&](LogLevel level, const char* kind, const std::string& what) {
    return Event{time, level, kind, target.name + " " + what};
  };
  const bool is_known = target.estimate.has_value() && target.entropy_nats < prior_nats_;
  switch (state_) {
    case State::kSought:
      if (!target.discovered_s) {
        return std::nullopt;
      }
      state_ = State::kKnown;
      return event(LogLevel::kInfo, "found", "found by " + target.discovered_by);
    case State::kKnown:
      // The estimate is evaluated some steps after the discovery.
      has_estimate_ |= is_known;
      if (is_known || !has_estimate_) {
        return std::nullopt;
      }
      state_ = State::kLost;
      return event(LogLevel::kWarning, "lost",
                   target.estimate
                       ? "lost: the estimate is as uncertain as before the target was found"
                       : "lost: no robot has an estimate");
    case State::kLost:
      if (!is_known || target.entropy_nats > prior_nats_ - kRegain_nats) {
        return std::nullopt;
      }
      state_ = State::kKnown;
      return event(LogLevel::kInfo, "found",
                   seen_by.empty() ? "found again" : "found again by " + seen_by);
  }
  return std::nullopt;
}

const char* name_of(TargetStory::State state) {
  constexpr const char* kNames[] = {"sought", "known", "lost"};
  return kNames[static_cast<int>(state)];
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
    const std::optional<std::string> lost = before ? losses(*before, health) : std::string();
    if (!lost) {
      return std::nullopt;
    }
    degraded_ = {now, now};
    return event(
        LogLevel::kWarning,
        "degraded: " + (lost->empty() ? "drops, missed deadlines or other errors" : *lost));
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
