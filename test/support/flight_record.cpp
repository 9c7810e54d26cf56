#include "test/support/flight_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "models/world/world.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/log_decode.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

/// Returns false for messages of an old log that was replayed during the flight.
bool is_current(const models::Stamp& stamp, const lcm::LogEvent& event) {
  return std::abs(to_utime(stamp.time) - event.timestamp) < 2'000'000;
}

constexpr double kLowM = 0.5;       // m; a flying vehicle below it lands or takes off
constexpr double kReactionS = 0.2;  // s; a vehicle that starts to move still accelerates

/// Returns the name of a reason, e.g. "pose lost" of "pose lost; pose_age_s > pose_age_land_s".
std::string name_of_reason(const std::string& reason) { return reason.substr(0, reason.find(';')); }

void add_new(const std::vector<std::string>& words, std::vector<std::string>& known) {
  for (const std::string& word : words) {
    if (std::ranges::find(known, word) == known.end()) {
      known.push_back(word);
    }
  }
}

}  // namespace

void FlightRecord::take(const lcm::LogEvent& event) {
  if (event.channel == "SCENARIO" && !scenario_) {
    if (const auto notice = decode<models::ScenarioNotice, vantage_lcm::scenario_t>(event)) {
      scenario_ = scenario::parse_scenario(notice->yaml, "SCENARIO");
    }
  } else if (event.channel == "TRUTH") {
    const auto truth = decode<models::TruthFrame, vantage_lcm::truth_t>(event);
    if (truth && is_current(truth->stamp, event) && is_of_flight(truth->stamp, "")) {
      for (const models::TruthBody& body : truth->bodies) {
        if (body.target_id < 0) {
          robots_[body.name].truth.push_back({truth->stamp.time, body.world_from_body.translation_m,
                                              body.velocity_world_mps,
                                              flatten(body.world_from_body).yaw_rad});
        }
      }
    }
  } else if (event.channel.starts_with("VEHICLE_")) {
    const auto status = decode<models::VehicleStatus, vantage_lcm::vehicle_t>(event);
    if (status && is_current(status->stamp, event) && is_of_flight(status->stamp, status->robot)) {
      robots_[status->robot].said.push_back(*status);
      has_anybody_followed_ = has_anybody_followed_ || status->state == FlightState::kFollow;
    }
  } else if (event.channel == "COLLISION") {
    const auto contact = decode<models::CollisionReport, vantage_lcm::collision_t>(event);
    if (contact && contact->kind == models::CollisionKind::kCollision) {
      take_contact(*contact);
    }
  } else if (event.channel.starts_with("HEALTH_") && has_anybody_followed_) {
    const auto health = decode<models::ProcessHealth, vantage_lcm::health_t>(event);
    if (health && is_current(health->stamp, event)) {
      take_health(*health);
    }
  }
}

void FlightRecord::take_health(const models::ProcessHealth& health) {
  Usage now{health.stamp, -1, -1};
  for (const models::NamedCount& counter : health.counters) {
    now.cpu_us = counter.name == "process.cpu_us" ? counter.count : now.cpu_us;
    now.waited_us = counter.name == "process.waited_us" ? counter.count : now.waited_us;
  }
  if (now.cpu_us < 0) {
    return;
  }
  const auto [before, is_first] = usage_.try_emplace(health.process, now);
  if (!is_first && before->second.said.run_id == now.said.run_id) {
    MachineShare share{health.process, before->second.said.time, now.said.time, 0.0, std::nullopt};
    share.used_s = 1e-6 * static_cast<double>(now.cpu_us - before->second.cpu_us);
    if (now.waited_us >= 0) {
      share.waited_s = 1e-6 * static_cast<double>(now.waited_us - before->second.waited_us);
    }
    machine_shares_.push_back(std::move(share));
  }
  before->second = now;
}

void FlightRecord::take_contact(const models::CollisionReport& contact) {
  const std::string& a = contact.body_a;
  const std::string& b = contact.body_b;
  const bool has_two_robots = robots_.count(a) > 0 && robots_.count(b) > 0;
  collisions_.push_back({a + " with " + b + state_of(a) + state_of(b),
                         !has_two_robots && (is_landed_blind(a) || is_landed_blind(b))});
}

std::string FlightRecord::state_of(const std::string& body) const {
  const auto robot = robots_.find(body);
  if (robot == robots_.end() || robot->second.said.empty() || robot->second.truth.empty()) {
    return "";
  }
  const models::VehicleStatus& said = robot->second.said.back();
  std::vector<std::string> reasons;
  for (const std::string& reason : said.reasons) {
    reasons.push_back(name_of_reason(reason));
  }
  return fmt::format("; {} was at {:.2f} m, {}: {}", body,
                     robot->second.truth.back().position_m.z(), name_of(said.state),
                     fmt::join(reasons, ", "));
}

// The reason "waiting for touch-down" means that the driver has left the landing to the autopilot.
bool FlightRecord::is_landed_blind(const std::string& body) const {
  const auto robot = robots_.find(body);
  if (robot == robots_.end() || robot->second.said.empty()) {
    return false;
  }
  const models::VehicleStatus& said = robot->second.said.back();
  const auto gives = [&](const char* reason) {
    return std::ranges::find(said.reasons, reason, name_of_reason) != said.reasons.end();
  };
  return gives("pose lost") && gives("waiting for touch-down");
}

// Refuses messages of a second trial on the same network. A restarted process has a new run.
bool FlightRecord::is_of_flight(const models::Stamp& stamp, const std::string& robot) {
  constexpr double kSilentS = 0.5;  // s; a driver publishes its state ten times per second
  const auto [newest, is_first] = newest_.try_emplace(robot, stamp);
  const bool is_silent = to_seconds(stamp.time - newest->second.time) > kSilentS;
  const bool is_other = stamp.run_id != newest->second.run_id;
  if (is_other && !is_silent) {
    ++(robot.empty() ? truth_strangers_ : robots_[robot].strangers);
    return false;
  }
  if (!robot.empty()) {
    robots_[robot].runs += is_first || is_other ? 1 : 0;
  }
  newest->second = stamp;
  return true;
}

bool FlightRecord::is_low(const At& at, const scenario::RobotSpec& spec) {
  return !spec.rover && at.position_m.z() < kLowM;
}

std::optional<Eigen::Vector3d> FlightRecord::place(const Robot& robot, Time time) const {
  const auto later = std::lower_bound(robot.truth.begin(), robot.truth.end(), time,
                                      [](const At& at, Time wanted) { return at.time < wanted; });
  if (later == robot.truth.begin() || later == robot.truth.end()) {
    return std::nullopt;
  }
  const At& before = *(later - 1);
  const double share = to_seconds(time - before.time) / to_seconds(later->time - before.time);
  return Eigen::Vector3d(before.position_m + share * (later->position_m - before.position_m));
}

CourseMetrics FlightRecord::summary(const std::string& name, const Robot& robot) const {
  CourseMetrics out;
  const scenario::RobotSpec* const spec = scenario_ ? scenario_->find_robot(name) : nullptr;
  const auto follows = [](const models::VehicleStatus& said) {
    return said.state == FlightState::kFollow;
  };
  const auto first = std::find_if(robot.said.begin(), robot.said.end(), follows);
  // The end is the last status in FOLLOW or HOLD: the final landing begins after it.
  const auto last_in_air =
      std::find_if(robot.said.rbegin(), robot.said.rend(), [](const models::VehicleStatus& said) {
        return said.state == FlightState::kFollow || said.state == FlightState::kHold;
      });
  if (spec == nullptr || first == robot.said.end()) {
    return out;
  }
  const Time begin = first->stamp.time;
  const Time end = last_in_air->stamp.time;
  double following_s = 0.0;
  double square_sum_m2 = 0.0;
  int samples = 0;
  for (auto said = first; said + 1 != robot.said.end() && said->stamp.time < end; ++said) {
    const double lasted_s = to_seconds((said + 1)->stamp.time - said->stamp.time);
    out.airborne_s += lasted_s;
    following_s += follows(*said) ? lasted_s : 0.0;
    for (const std::string& reason : said->reasons) {
      out.reasons[reason] += lasted_s;
    }
    const auto here_m = place(robot, said->stamp.time);
    if (!here_m) {
      continue;
    }
    const Eigen::Vector3d asked_m(said->setpoint.x_m, said->setpoint.y_m, said->setpoint_height_m);
    const double error_m = (*here_m - asked_m).norm();
    if (follows(*said)) {
      square_sum_m2 += error_m * error_m;
      ++samples;
      out.setpoint_error_max_m = std::max(out.setpoint_error_max_m, error_m);
    } else if (said->state == FlightState::kHold) {
      out.hold_error_max_m = std::max(out.hold_error_max_m, error_m);
    }
  }
  judge_words(robot, begin, end, spec->limits.speed_max_mps, out);
  judge_turns(robot, begin, end, *spec, out);
  out.follow_share = out.airborne_s > 0.0 ? following_s / out.airborne_s : 0.0;
  out.setpoint_error_rms_m = samples > 0 ? std::sqrt(square_sum_m2 / samples) : 0.0;
  out.separation_least_m = std::numeric_limits<double>::infinity();
  for (const At& at : robot.truth) {
    if (at.time < begin || is_low(at, *spec)) {
      continue;
    }
    out.speed_max_share = std::max(out.speed_max_share,
                                   at.velocity_mps.head<2>().norm() / spec->limits.speed_max_mps);
    out.outside_max_m = std::max(out.outside_max_m,
                                 -models::clearance_m(scenario_->world, at.position_m.head<2>()));
    for (const auto& [other_name, other] : robots_) {
      if (other_name != name) {
        if (const auto other_m = place(other, at.time)) {
          out.separation_least_m =
              std::min(out.separation_least_m, (*other_m - at.position_m).norm());
        }
      }
    }
  }
  return out;
}

void FlightRecord::judge_words(const Robot& robot, Time begin, Time end, double speed_max_mps,
                               CourseMetrics& out) {
  out.runs = robot.runs;
  out.strangers = robot.strangers;
  const models::VehicleStatus* last = nullptr;
  for (const models::VehicleStatus& said : robot.said) {
    if (said.stamp.time < begin || said.stamp.time > end) {
      continue;
    }
    if (last != nullptr) {
      const double gap_s = to_seconds(said.stamp.time - last->stamp.time);
      out.status_gap_max_s = std::max(out.status_gap_max_s, gap_s);
      const double moved_m = (said.setpoint.position_m() - last->setpoint.position_m()).norm();
      // Braking starts at the vehicle's position, so the set-point may jump there.
      if (last->state == FlightState::kFollow && said.state == FlightState::kFollow) {
        out.setpoint_jump_max_m =
            std::max(out.setpoint_jump_max_m, moved_m - speed_max_mps * gap_s);
      }
    }
    last = &said;
  }
}

void FlightRecord::judge_turns(const Robot& robot, Time begin, Time end,
                               const scenario::RobotSpec& spec, CourseMetrics& out) {
  constexpr double kWindowS = 0.1;
  std::size_t first = 0;  // first sample of the window that ends at each moment
  for (std::size_t i = 1; i < robot.truth.size(); ++i) {
    const At& at = robot.truth[i];
    if (at.time < begin || at.time > end) {
      first = i;
      continue;
    }
    out.truth_gap_max_s =
        std::max(out.truth_gap_max_s, to_seconds(at.time - robot.truth[i - 1].time));
    while (first + 1 < i && to_seconds(at.time - robot.truth[first + 1].time) >= kWindowS) {
      ++first;
    }
    const double window_s = to_seconds(at.time - robot.truth[first].time);
    if (window_s >= kWindowS && !is_low(at, spec)) {
      const double turned_rad = std::abs(wrap_to_pi(at.yaw_rad - robot.truth[first].yaw_rad));
      out.turn_max_share =
          std::max(out.turn_max_share, turned_rad / window_s / spec.limits.yaw_rate_max_radps);
    }
  }
}

std::optional<Stop> FlightRecord::stop_at(const Robot& robot, std::size_t said) {
  constexpr double kWatchedS = 2.5;
  constexpr double kStayedS = 1.0;
  constexpr double kStillMps = 0.1;
  const models::VehicleStatus& first = robot.said[said];
  const Time begin = first.stamp.time;
  for (std::size_t i = said; i < robot.said.size(); ++i) {
    const double since_s = to_seconds(robot.said[i].stamp.time - begin);
    if (since_s > kStayedS) {
      break;
    }
    if (robot.said[i].state != FlightState::kHold) {
      return std::nullopt;
    }
  }
  Stop out;
  out.begin = begin;
  out.reason = first.reasons.empty() ? "" : first.reasons.front();
  const At* from = nullptr;
  for (const At& at : robot.truth) {
    const double since_s = to_seconds(at.time - begin);
    if (since_s < 0.0 || since_s > kWatchedS) {
      continue;
    }
    if (from == nullptr) {
      from = &at;
    }
    if (since_s <= kReactionS) {
      out.speed_mps = std::max(out.speed_mps, at.velocity_mps.head<2>().norm());
    }
    out.distance_m = std::max(out.distance_m, (at.position_m - from->position_m).head<2>().norm());
    if (at.velocity_mps.head<2>().norm() > kStillMps) {
      out.still_after_s = since_s;
    }
  }
  return from == nullptr ? std::nullopt : std::optional(out);
}

std::optional<EventResponse> FlightRecord::after(const std::string& name, Time event) const {
  constexpr double kStopS = 3.0;
  constexpr double kWatchedS = 12.0;
  constexpr double kCourseS = 8.0;
  constexpr double kDownS = 30.0;
  constexpr double kDownM = 0.15;
  constexpr double kSaidS = 45.0;
  constexpr double kReasonS = 1.0;
  const auto robot = robots_.find(name);
  if (robot == robots_.end() || !scenario_) {
    return std::nullopt;
  }
  const auto begin = std::lower_bound(robot->second.truth.begin(), robot->second.truth.end(), event,
                                      [](const At& at, Time wanted) { return at.time < wanted; });
  if (begin == robot->second.truth.end()) {
    return std::nullopt;
  }
  EventResponse out;
  out.separation_m = std::numeric_limits<double>::infinity();
  std::optional<FlightState> state;
  for (const models::VehicleStatus& said : robot->second.said) {
    const double since_s = to_seconds(said.stamp.time - event);
    if (since_s >= 0.0 && since_s <= kSaidS && state && said.state != *state) {
      out.said.push_back({said.state, since_s, {}});
    }
    state = said.state;
    if (!out.said.empty() && since_s <= out.said.back().after_s + kReasonS) {
      add_new(said.reasons, out.said.back().reasons);
    }
    const bool is_flown = said.state == FlightState::kFollow || said.state == FlightState::kHold;
    const auto here_m = since_s >= 0.0 && since_s <= kCourseS && is_flown
                            ? place(robot->second, said.stamp.time)
                            : std::nullopt;
    if (here_m) {
      const Eigen::Vector2d asked_m(said.setpoint.x_m, said.setpoint.y_m);
      out.off_course_m = std::max(out.off_course_m, (here_m->head<2>() - asked_m).norm());
    }
  }
  for (auto at = begin; at != robot->second.truth.end(); ++at) {
    const double since_s = to_seconds(at->time - event);
    if (since_s > kDownS) {
      break;
    }
    if (at->position_m.z() < kDownM && !out.down_s) {
      out.down_s = since_s;
    }
    if (since_s <= kReactionS) {
      out.speed_mps = std::max(out.speed_mps, at->velocity_mps.head<2>().norm());
    }
    if (since_s <= kStopS) {
      out.distance_m =
          std::max(out.distance_m, (at->position_m - begin->position_m).head<2>().norm());
    }
    if (since_s > kWatchedS) {
      continue;
    }
    out.outside_m =
        std::max(out.outside_m, -models::clearance_m(scenario_->world, at->position_m.head<2>()));
    for (const auto& [other_name, other] : robots_) {
      const auto other_m = other_name == name ? std::nullopt : place(other, at->time);
      if (other_m && other_m->z() > kLowM && at->position_m.z() > kLowM) {
        out.separation_m = std::min(out.separation_m, (*other_m - at->position_m).norm());
      }
    }
  }
  return out;
}

std::map<std::string, std::vector<Stop>> FlightRecord::stops() const {
  std::map<std::string, std::vector<Stop>> out;
  for (const auto& [name, robot] : robots_) {
    for (std::size_t i = 1; i < robot.said.size(); ++i) {
      if (robot.said[i - 1].state == FlightState::kFollow &&
          robot.said[i].state == FlightState::kHold) {
        if (const auto stop = stop_at(robot, i)) {
          out[name].push_back(*stop);
        }
      }
    }
  }
  return out;
}

std::map<std::string, CourseMetrics> FlightRecord::summaries() const {
  std::map<std::string, CourseMetrics> out;
  for (const auto& [name, robot] : robots_) {
    out[name] = summary(name, robot);
  }
  return out;
}

std::string to_text(const std::string& robot, const CourseMetrics& kept) {
  std::string out = fmt::format(
      "{}: followed {:.1f} % of {:.1f} s; set-point error {:.3f} m rms, {:.2f} at most, {:.2f} in "
      "hold; {:.2f} of the speed limit; {:.2f} m outside; {:.2f} m from others",
      robot, 100.0 * kept.follow_share, kept.airborne_s, kept.setpoint_error_rms_m,
      kept.setpoint_error_max_m, kept.hold_error_max_m, kept.speed_max_share, kept.outside_max_m,
      kept.separation_least_m);
  for (const auto& [reason, seconds] : kept.reasons) {
    out += fmt::format("; {} {:.1f} s", reason, seconds);
  }
  return out;
}

}  // namespace vantage::test
