// hil_check [--strict [--speed-share MOST]] [--events FILE] LOG [ROBOT…]
// hil_check --held-up LOG
// hil_check --collisions LOG
// hil_check --flown ROUNDS LOG
//
// Reads the log of a trial with devices on the wire. Checks that every vehicle took off, followed
// plans of the team and landed, that no collision was found, and that VICON has no gap after the
// first plan is followed. The named robots (ground robots, `direct` ones) may stay at their
// heights, but must follow plans and move. A ground robot has no minimum share of time in FOLLOW:
// it is held while a target that its planner does not know is in its path. Prints its observations,
// and the latency of poses and set-points at the autopilots.
//
// Exit code 0 if all checks pass; with --strict only if all flight invariants hold, too (each
// violation is printed as BROKEN). --speed-share is the maximum of the speed invariant. Timing is
// not judged where an overloaded host delayed the flight (HELD UP): test/support/flight_invariants.
// FILE is the output of flight_drill: one line per event and vehicle and a table are then printed.
//
// --held-up, --collisions and --flown each check one thing only: whether the host delayed the
// flight, whether no collision was found, or whether every robot of the scenario has followed
// plans of ROUNDS rounds (also in a log that is still being written). Exit code 0 if so.

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "bus/convert/convert.hpp"
#include "drivers/safety/limits.hpp"
#include "test/support/flight_invariants.hpp"
#include "test/support/flight_record.hpp"
#include "test/support/log_decode.hpp"
#include "test/support/sanitizer.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
using models::FlightState;
using test::decode;

struct Flight {
  std::set<std::int64_t> rounds;  // rounds with a plan that was followed
  double highest_m = 0.0;
  double last_m = 0.0;
  std::optional<Eigen::Vector2d> first_m;
  double farthest_m = 0.0;  // m; greatest distance from the first position
  FlightState state = FlightState::kIdle;
  std::set<std::string> ended_for;  // reasons reported while killed or before the first plan
};

struct Seen {
  std::map<std::string, Flight> flights;
  std::int64_t frames = 0;
  std::int64_t frame_gaps = 0;
  std::int64_t frames_lost_on_lcm = 0;
  std::optional<models::MocapFrame> last_frame;
  std::map<std::string, std::int64_t> counters;  // newest value of each process
};

void on_frame(const models::MocapFrame& frame, Seen& seen) {
  ++seen.frames;
  const bool is_flown = std::ranges::any_of(
      seen.flights, [](const auto& flight) { return !flight.second.rounds.empty(); });
  if (seen.last_frame && is_flown) {
    seen.frame_gaps += frame.frame_number == seen.last_frame->frame_number + 1 ? 0 : 1;
    seen.frames_lost_on_lcm += frame.stamp.sequence == seen.last_frame->stamp.sequence + 1 ? 0 : 1;
  }
  seen.last_frame = frame;
}

void take(const lcm::LogEvent& event, Seen& seen) {
  if (event.channel == "VICON") {
    if (const auto frame = decode<models::MocapFrame, vantage_lcm::mocap_frame_t>(event)) {
      on_frame(*frame, seen);
    }
  } else if (event.channel == "TRUTH") {
    if (const auto truth = decode<models::TruthFrame, vantage_lcm::truth_t>(event)) {
      for (const models::TruthBody& body : truth->bodies) {
        if (body.target_id < 0) {
          Flight& flight = seen.flights[body.name];
          flight.last_m = body.world_from_body.translation_m.z();
          flight.highest_m = std::max(flight.highest_m, flight.last_m);
          const Eigen::Vector2d at_m = body.world_from_body.translation_m.head<2>();
          flight.first_m = flight.first_m.value_or(at_m);
          flight.farthest_m = std::max(flight.farthest_m, (at_m - *flight.first_m).norm());
        }
      }
    }
  } else if (event.channel.starts_with("VEHICLE_")) {
    if (const auto status = decode<models::VehicleStatus, vantage_lcm::vehicle_t>(event)) {
      Flight& flight = seen.flights[status->robot];
      flight.state = status->state;
      if (status->state == FlightState::kKilled || flight.rounds.empty()) {
        flight.ended_for.insert(status->reasons.begin(), status->reasons.end());
      }
      if (status->state == FlightState::kFollow && status->plan_round >= 0) {
        flight.rounds.insert(status->plan_round);
      }
    }
  } else if (event.channel.starts_with("HEALTH_")) {
    if (const auto health = decode<models::ProcessHealth, vantage_lcm::health_t>(event)) {
      for (const models::NamedCount& counter : health->counters) {
        seen.counters[health->process + " " + counter.name] = counter.count;
      }
    }
  }
}

bool judge_collisions(const test::FlightRecord& record, const test::FlightBounds& bounds) {
  std::printf("%zu collisions\n", record.collisions().size());
  for (const test::Collision& each : record.collisions()) {
    std::printf("collision: %s\n", each.text.c_str());
  }
  const auto judged = test::collisions(record, bounds).size();
  if (judged < record.collisions().size()) {
    std::printf("%zu of them are not judged: landings without a pose\n",
                record.collisions().size() - judged);
  }
  return judged == 0;
}

bool judge(const Seen& seen, const std::set<std::string>& level, bool is_held_up) {
  const bool has_gaps = seen.frame_gaps > 0 || seen.frames_lost_on_lcm > 0;
  bool is_good = seen.frames > 0 && (is_held_up || !has_gaps) && !seen.flights.empty();
  std::printf("VICON: %lld frames, %lld gaps, %lld lost on LCM\n",
              static_cast<long long>(seen.frames), static_cast<long long>(seen.frame_gaps),
              static_cast<long long>(seen.frames_lost_on_lcm));
  for (const auto& [robot, flight] : seen.flights) {
    // Without a pose, the autopilot stops the motors near the floor.
    const bool ends_blind = is_held_up && flight.state == FlightState::kKilled &&
                            std::ranges::any_of(flight.ended_for, [](const std::string& reason) {
                              return reason.starts_with("pose lost low");
                            });
    const bool has_landed =
        (flight.state == FlightState::kIdle || ends_blind) && flight.last_m < 0.1;
    std::printf("%s: up to %.2f m, %zu rounds followed, %.2f m away, %s at %.2f m\n", robot.c_str(),
                flight.highest_m, flight.rounds.size(), flight.farthest_m, name_of(flight.state),
                flight.last_m);
    if (flight.rounds.empty()) {
      for (const std::string& reason : flight.ended_for) {
        std::printf("%s said: %s\n", robot.c_str(), reason.c_str());
      }
    }
    const bool has_flown = flight.highest_m > 0.8 && has_landed;
    is_good = is_good && !flight.rounds.empty() && flight.farthest_m > 0.5 &&
              (has_flown || level.count(robot) > 0);
  }
  for (const auto& [name, count] : seen.counters) {
    if (name.ends_with("_us")) {
      std::printf("%s %lld\n", name.c_str(), static_cast<long long>(count));
    }
  }
  return is_good;
}

bool have_flown(const Seen& seen, const test::FlightRecord& record, std::size_t rounds) {
  return record.scenario() &&
         std::ranges::all_of(record.scenario()->robots, [&](const scenario::RobotSpec& robot) {
           const auto flight = seen.flights.find(robot.name);
           return flight != seen.flights.end() && flight->second.rounds.size() >= rounds;
         });
}

void print_stops(const test::FlightRecord& record) {
  for (const auto& [robot, stops] : record.stops()) {
    double farthest_m = 0.0;
    double longest_s = 0.0;
    double fastest_mps = 0.0;
    double beyond_m = -1e9;
    const drivers::SafetyLimits limits = drivers::limits_for(*record.scenario(), robot);
    for (const test::Stop& stop : stops) {
      beyond_m = std::max(beyond_m,
                          stop.distance_m - drivers::stopping_distance_m(limits, stop.speed_mps));
      if (stop.distance_m > farthest_m) {
        farthest_m = stop.distance_m;
        fastest_mps = stop.speed_mps;
      }
      longest_s = std::max(longest_s, stop.still_after_s);
    }
    std::printf(
        "%s: %zu stops, the longest %.2f m from %.2f m/s, %+.2f m of the budget at most, still "
        "after %.2f s\n",
        robot.c_str(), stops.size(), farthest_m, fastest_mps, beyond_m, longest_s);
  }
}

void print_machine(const test::FlightRecord& record) {
  double busiest = 0.0;
  double longest_s = 0.0;
  for (const test::MachineShare& share : record.machine_shares()) {
    busiest = std::max(busiest, test::processors_used(record, share.since, share.until));
    longest_s = std::max(longest_s, share.waited_s.value_or(0.0));
  }
  std::printf("all processes: %.2f processors, %.2f in the busiest second; one waited %.3f s\n",
              test::processors_used(record), busiest, longest_s);
}

bool judge_course(const test::FlightRecord& record, const test::FlightBounds& bounds) {
  for (const auto& [robot, kept] : record.summaries()) {
    std::printf("%s\n", test::to_text(robot, kept).c_str());
  }
  const std::vector<std::string> broken = test::violations(record, bounds);
  for (const std::string& each : broken) {
    std::printf("BROKEN %s\n", each.c_str());
  }
  return broken.empty();
}

struct Worst {
  int times = 0;
  int moving = 0;  // number of vehicles that moved when their event began
  double speed_mps = 0.0;
  double distance_m = 0.0;
  double beyond_m = -1e9;  // m; greatest distance travelled beyond the budget
  double outside_m = 0.0;
  double separation_m = 1e9;
  double off_course_m = 0.0;
  double down_s = 0.0;
  int not_down = 0;
};

constexpr double kMovingMps = 0.1;

// Returns the distance, m, that a vehicle may travel after the event: the distance until it has
// stopped. If its driver is stopped, killed or cut off, the autopilot's time-out is included.
// Without an operator, the vehicle first follows its plan until the absence is detected.
double budget_m(const std::string& what, const drivers::SafetyLimits& limits, double speed_mps) {
  if (what == "hold") {
    return drivers::stopping_distance_m(limits, speed_mps);
  }
  if (what == "stop:up") {
    const double plan_mps = limits.vehicle.speed_max_mps;
    return limits.operator_age_hold_s * plan_mps + drivers::stopping_distance_m(limits, plan_mps);
  }
  return drivers::stopping_distance_after_loss_m(limits, speed_mps);
}

void judge_events(const std::string& path, const test::FlightRecord& record) {
  std::ifstream file(path);
  std::map<std::string, Worst> table;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::int64_t utime = 0;
    std::string what;
    words >> utime >> what;
    for (std::string robot; words >> robot;) {
      const auto after = record.after(robot, from_utime(utime));
      if (!after) {
        continue;
      }
      const double allowed_m =
          budget_m(what, drivers::limits_for(*record.scenario(), robot), after->speed_mps);
      std::printf(
          "%s %s: %.2f m/s, %.2f m further (%.2f budgeted), %.2f m outside, %.2f m from "
          "others, %.2f m off course, down after %.1f s\n",
          what.c_str(), robot.c_str(), after->speed_mps, after->distance_m, allowed_m,
          after->outside_m, after->separation_m, after->off_course_m, after->down_s.value_or(-1.0));
      std::printf("SAID %s %s", what.c_str(), robot.c_str());
      for (const test::Reaction& reaction : after->said) {
        std::printf("; %s %.2f", name_of(reaction.state), reaction.after_s);
        for (const std::string& reason : reaction.reasons) {
          std::printf(" (%.*s)", static_cast<int>(reason.find(';')), reason.c_str());
        }
      }
      std::printf("\n");
      Worst& worst = table[what];
      ++worst.times;
      worst.moving += after->speed_mps > kMovingMps ? 1 : 0;
      worst.speed_mps = std::max(worst.speed_mps, after->speed_mps);
      worst.distance_m = std::max(worst.distance_m, after->distance_m);
      worst.beyond_m = std::max(worst.beyond_m, after->distance_m - allowed_m);
      worst.outside_m = std::max(worst.outside_m, after->outside_m);
      worst.separation_m = std::min(worst.separation_m, after->separation_m);
      worst.off_course_m = std::max(worst.off_course_m, after->off_course_m);
      worst.down_s = std::max(worst.down_s, after->down_s.value_or(0.0));
      worst.not_down += after->down_s ? 0 : 1;
    }
  }
  for (const auto& [what, worst] : table) {
    std::printf(
        "EVENTS %s: %d times, %d from motion, up to %.2f m/s, %.2f m further at most, %+.2f m of "
        "the budget, %.2f m outside, %.2f m from others, %.2f m off course, down within %.1f s but "
        "%d\n",
        what.c_str(), worst.times, worst.moving, worst.speed_mps, worst.distance_m, worst.beyond_m,
        worst.outside_m, worst.separation_m, worst.off_course_m, worst.down_s, worst.not_down);
  }
}

struct Options {
  bool is_strict = false;
  bool checks_held_up = false;
  bool asks_collisions = false;
  std::optional<std::size_t> flown_rounds;
  std::string events;
  test::FlightBounds bounds;
  std::vector<std::string> words;
};

/// Returns nullopt if the arguments do not match the usage.
std::optional<Options> options_of(const std::vector<std::string>& arguments) {
  Options out;
  // If this program is sanitized, so are the judged processes, which makes them slower.
  out.bounds.is_slowed = VANTAGE_IS_SANITIZED != 0;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool has_value = i + 1 < arguments.size();
    if (arguments[i] == "--strict") {
      out.is_strict = true;
    } else if (arguments[i] == "--held-up") {
      out.checks_held_up = true;
    } else if (arguments[i] == "--collisions") {
      out.asks_collisions = true;
    } else if (arguments[i] == "--flown" && has_value) {
      out.flown_rounds = std::stoul(arguments[++i]);
    } else if (arguments[i] == "--events" && has_value) {
      out.events = arguments[++i];
    } else if (arguments[i] == "--speed-share" && has_value) {
      out.bounds.speed_max_share = std::stod(arguments[++i]);
    } else if (arguments[i].starts_with("-")) {
      return std::nullopt;
    } else {
      out.words.push_back(arguments[i]);
    }
  }
  return out.words.empty() ? std::nullopt : std::optional(out);
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = options_of({argv + 1, argv + argc});
  if (!options) {
    std::printf(
        "usage: hil_check [--strict [--speed-share MOST]] [--events FILE] LOG [ROBOT...]\n"
        "       hil_check --held-up LOG\n"
        "       hil_check --collisions LOG\n"
        "       hil_check --flown ROUNDS LOG\n");
    return 2;
  }
  const std::string& path = options->words.front();
  lcm::LogFile log(path, "r");
  if (!log.good()) {
    std::printf("cannot read %s\n", path.c_str());
    return 2;
  }
  Seen seen;
  test::FlightRecord record;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    take(*event, seen);
    record.take(*event);
  }
  if (options->flown_rounds) {
    return have_flown(seen, record, *options->flown_rounds) ? 0 : 1;
  }
  const auto held_up = test::held_up(record, options->bounds);
  if (held_up) {
    std::printf("HELD UP, so what takes time is not judged: %s\n", held_up->c_str());
  }
  if (options->checks_held_up) {
    return held_up ? 0 : 1;
  }
  const bool is_clear = judge_collisions(record, options->bounds);
  if (options->asks_collisions) {
    return is_clear ? 0 : 1;
  }
  const std::set<std::string> level(options->words.begin() + 1, options->words.end());
  test::FlightBounds bounds = options->bounds;
  if (record.scenario()) {
    for (const scenario::RobotSpec& robot : record.scenario()->robots) {
      if (robot.rover) {
        bounds.may_hold.insert(robot.name);
      }
    }
  }
  print_machine(record);
  const bool keeps_course = judge_course(record, bounds);
  print_stops(record);
  if (!options->events.empty()) {
    judge_events(options->events, record);
  }
  const bool is_good = judge(seen, level, held_up.has_value());
  return is_clear && is_good && (keeps_course || !options->is_strict) ? 0 : 1;
}
