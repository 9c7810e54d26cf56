#include "test/support/flight_invariants.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace vantage::test {
namespace {

/// Collects the violations of one vehicle.
class Judge {
 public:
  Judge(const std::string& robot, std::vector<std::string>& out) : robot_(robot), out_(out) {}

  void at_most(const char* invariant, double is, double most, const char* unit) {
    if (!(is <= most)) {
      add(invariant, fmt::format("{:.3f} {} (at most {:g})", is, unit, most));
    }
  }
  void at_least(const char* invariant, double is, double least, const char* unit) {
    if (!(is >= least)) {
      add(invariant, fmt::format("{:.3f} {} (at least {:g})", is, unit, least));
    }
  }
  void add(const char* invariant, const std::string& what) {
    out_.push_back(fmt::format("{} {}: {}", robot_, invariant, what));
  }

 private:
  const std::string& robot_;
  std::vector<std::string>& out_;
};

/// Returns the distance of centres at which `robot` touches the largest other robot, m.
double contact_m(const scenario::Scenario& scenario, const scenario::RobotSpec& robot) {
  double radius_m = 0.0;
  for (const scenario::RobotSpec& other : scenario.robots) {
    if (other.name != robot.name) {
      radius_m = std::max(radius_m, other.limits.radius_m);
    }
  }
  return robot.limits.radius_m + radius_m;
}

// Judges the invariants that must hold whether or not the host delayed the flight.
void judge_safety(const CourseMetrics& kept, double contact_m, const FlightBounds& bounds,
                  Judge& judge) {
  judge.at_least("separation", kept.separation_least_m, contact_m, "m from another");
  judge.at_most("fence", kept.outside_max_m, bounds.outside_max_m, "m outside");
  if (const auto fence = kept.reasons.find("fence"); fence != kept.reasons.end()) {
    judge.add("fence", fmt::format("landed for it, {:.1f} s", fence->second));
  }
  if (kept.strangers > 0) {
    judge.add("believed", fmt::format("{} words in its name of another", kept.strangers));
  }
  if (kept.runs > bounds.runs_max) {
    judge.add("believed", fmt::format("{} drivers one after the other (at most {})", kept.runs,
                                      bounds.runs_max));
  }
}

// Judges the invariants that must hold only if every process ran in time.
void judge_course(const CourseMetrics& kept, bool may_hold, const FlightBounds& bounds,
                  Judge& judge) {
  if (!may_hold) {
    judge.at_least("following", kept.follow_share, bounds.follow_share_min, "of its time");
  }
  judge.at_most("set-point error", kept.setpoint_error_rms_m, bounds.setpoint_error_rms_max_m,
                "m rms");
  judge.at_most("speed", kept.speed_max_share, bounds.speed_max_share, "of its limit");
  judge.at_most("turn", kept.turn_max_share, bounds.turn_max_share, "of its limit");
  judge.at_most("continuity", kept.setpoint_jump_max_m, bounds.setpoint_jump_max_m,
                "m from one set-point to the next beyond its speed");
  judge.at_most("ages", kept.status_gap_max_s, bounds.gap_max_s, "s without a word");
  judge.at_most("ages", kept.truth_gap_max_s, bounds.gap_max_s, "s without being seen");
}

}  // namespace

double processors_used(const FlightRecord& record, Time begin, Time end) {
  double used_s = 0.0;
  for (const MachineShare& share : record.machine_shares()) {
    const double within_s = to_seconds(std::min(end, share.until) - std::max(begin, share.since));
    if (within_s > 0.0) {
      used_s += share.used_s * within_s / to_seconds(share.until - share.since);
    }
  }
  return end > begin ? used_s / to_seconds(end - begin) : 0.0;
}

double processors_used(const FlightRecord& record) {
  const auto& shares = record.machine_shares();
  if (shares.empty()) {
    return 0.0;
  }
  const auto first = std::ranges::min_element(shares, {}, &MachineShare::since);
  const auto last = std::ranges::max_element(shares, {}, &MachineShare::until);
  return processors_used(record, first->since, last->until);
}

std::optional<std::string> held_up(const FlightRecord& record, const FlightBounds& bounds) {
  if (bounds.is_slowed) {
    return "a sanitizer slows all down";
  }
  const MachineShare* longest = nullptr;
  for (const MachineShare& share : record.machine_shares()) {
    const double most_s = longest != nullptr ? *longest->waited_s : bounds.held_up_max_s;
    if (share.waited_s.value_or(0.0) > most_s &&
        processors_used(record, share.since, share.until) <= bounds.processors_held_up_max) {
      longest = &share;
    }
  }
  if (longest == nullptr) {
    return std::nullopt;
  }
  return fmt::format("{} waited {:.2f} s for a processor in the second before {} (at most {:g})",
                     longest->process, *longest->waited_s, to_utime(longest->until),
                     bounds.held_up_max_s);
}

std::vector<std::string> collisions(const FlightRecord& record, const FlightBounds& bounds) {
  const bool is_held_up = held_up(record, bounds).has_value();
  std::vector<std::string> out;
  for (const Collision& each : record.collisions()) {
    if (!(is_held_up && each.is_of_blind_landing)) {
      out.push_back(each.text);
    }
  }
  return out;
}

std::vector<std::string> violations(const FlightRecord& record, const FlightBounds& bounds) {
  std::vector<std::string> out;
  const auto summaries = record.summaries();
  if (!record.scenario() || summaries.empty()) {
    return {"nothing flew: no SCENARIO, or no vehicle"};
  }
  if (record.truth_strangers() > 0) {
    out.push_back(
        fmt::format("TRUTH believed: {} frames of another simulation", record.truth_strangers()));
  }
  const double processors = processors_used(record);
  if (!bounds.is_slowed && processors > bounds.processors_max) {
    out.push_back(fmt::format("TEAM processors: {:.2f} used (at most {:g})", processors,
                              bounds.processors_max));
  }
  const bool is_held_up = held_up(record, bounds).has_value();
  for (const auto& [name, kept] : summaries) {
    Judge of_robot(name, out);
    const scenario::RobotSpec* const robot = record.scenario()->find_robot(name);
    if (robot == nullptr) {
      of_robot.add("believed", "the scenario does not know it");
      continue;
    }
    if (!(kept.airborne_s > 0.0)) {
      of_robot.add("following", "it never followed a plan");
      continue;
    }
    judge_safety(kept, contact_m(*record.scenario(), *robot), bounds, of_robot);
    if (!is_held_up) {
      judge_course(kept, bounds.may_hold.contains(name), bounds, of_robot);
    }
  }
  return out;
}

}  // namespace vantage::test
