// flight_drill SCENARIO WHAT TIMES SEED EVENTS
//
// The operator of a flight that `vantage up` runs. Arms all vehicles and has them follow. Then does
// WHAT to one vehicle, TIMES times in all, at seeded moments while all vehicles follow:
//
//   hold            sends `hold`, and `follow` after 2.5 s; one time in four to all vehicles
//   plan-loss       SIGSTOP to its planner and to restarted ones, for 8 s
//   cut             cuts its MAVLink link in both directions until it has landed
//   blip            cuts the link for 1.2 s
//   outage:SECONDS  SIGSTOP to the mocap driver and to restarted ones; affects all vehicles
//   stall:SECONDS   SIGSTOP to the vehicle's driver, which later handles the queued messages
//   pilot           another station takes the autopilot out of the driver's mode for 2.5 s
//   battery         its battery runs empty
//   motor           one of its motors stops permanently
//   kill:PROGRAM    SIGKILL, or with stop:PROGRAM SIGSTOP, to a process of `up`: planner,
//                   estimator, sensor, quadrotor (of that vehicle), vicon (affects all)
//
// WHAT may be a list of events that ground no vehicle, separated by commas: each happens TIMES
// times in all, and each vehicle has its own sequence, so that a short flight has many events.
// Kinds separated by + happen one kind after the other.
//
// Vehicles that have landed are flown again. Each event appends a line "µs WHAT ROBOT…" to EVENTS;
// its outcome is in the log (hil_check --events EVENTS LOG). Exit code 0 when all was done and all
// vehicles have landed.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/integration/drill_lanes.hpp"
#include "test/integration/processes.hpp"
#include "test/integration/second_station.hpp"
#include "tools/console/console.hpp"
#include "tools/up/flight_program.hpp"
#include "tools/up/process_plan.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
using models::FlightState;
using models::OperatorAction;

constexpr double kRestS = 2.5;
constexpr double kSilenceS = 8.0;
constexpr double kCutS = 16.0;  // s; an autopilot lands by itself within this time
constexpr double kBlipS = 1.2;
constexpr double kGiveUpS = 150.0;

std::vector<std::string> words_of(const std::string& text, char mark) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, mark);) {
    out.push_back(word);
  }
  return out;
}

/// Returns the seconds of "outage:SECONDS" or "stall:SECONDS".
double silence_s(const std::string& what) { return std::stod(what.substr(what.find(':') + 1)); }

bool is_outage(const std::string& what) { return what.starts_with("outage:"); }
bool is_stall(const std::string& what) { return what.starts_with("stall:"); }

/// True if the event makes the affected vehicle land, for example by 0.5 s without poses.
bool causes_landing(const std::string& what) {
  return what == "cut" || what == "battery" || what == "motor" || what.ends_with("quadrotor") ||
         what.ends_with("vicon") || ((is_outage(what) || is_stall(what)) && silence_s(what) > 0.4);
}

/// True if the event affects all vehicles at once.
bool is_shared(const std::string& what) { return what.ends_with("vicon") || is_outage(what); }

class Drill {
 public:
  Drill(const scenario::Scenario& scenario, const std::string& what, int times, std::uint64_t seed,
        const std::string& events)
      : scenario_(scenario),
        sequence_(words_of(what, '+')),
        times_(times),
        left_(times * static_cast<int>(std::max(words_of(what, ',').size(), sequence_.size()))),
        rng_(seed),
        events_(events),
        transport_(bus::open_transport(scenario.network.url)),
        bus_(*transport_, bus::random_run_id()),
        sender_(bus_, {}, clock_.now()),
        robots_(tools::robots_with_driver(scenario)),
        program_(robots_),
        program_since_(clock_.now()) {
    if (what.find(',') != std::string::npos) {
      lanes_.emplace(words_of(what, ','), times, seed);
    }
    bus_.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                          [this](const models::VehicleStatus& status) {
                                            program_.on_status(status);
                                            states_[status.robot] = status.state;
                                            if (lanes_) {
                                              lanes_->on_status(status);
                                            }
                                          });
  }

  bool run() {
    while (to_seconds(clock_.now() - program_since_) < kGiveUpS) {
      bus_.handle(std::chrono::milliseconds(10));
      const Time now = clock_.now();
      sender_.tick(now);
      if (!sender_.station().sends_heartbeat()) {
        continue;
      }
      if (left_ == 0 && !has_grounded_ && program_.is_down()) {
        return true;
      }
      step(now);
    }
    std::cerr << "given up: " << left_ << " times were not done\n";
    return false;
  }

 private:
  bool all(FlightState state) const {
    return states_.size() == robots_.size() &&
           std::all_of(states_.begin(), states_.end(),
                       [state](const auto& each) { return each.second == state; });
  }

  void step(Time now) {
    mend_links(now);
    keep_silent(now);
    give_back(now);
    if (has_grounded_) {
      go_round(now);
      return;
    }
    if (lanes_) {
      step_lanes(now);
      return;
    }
    if (is_anybody_down()) {  // landed for another reason: no events until all fly
      has_grounded_ = true;
      round_.clear();
      next_.reset();
      follow_at_.reset();
      last_act_ = now;
      return;
    }
    if (follow_at_ && now >= *follow_at_) {
      sender_.send(now, OperatorAction::kFollow, held_);
      follow_at_.reset();
      program_since_ = now;
    } else if (next_ && now >= *next_) {
      next_.reset();
      act(now);
    } else if (!next_ && !follow_at_ && silences_.empty() && cut_until_.empty() &&
               taken_until_.empty() && all(FlightState::kFollow)) {
      if (left_ == 0) {
        program_.land_all();
      } else {
        next_ = now + from_seconds(std::uniform_real_distribution<double>(1.5, 4.0)(rng_));
      }
    }
    if (!follow_at_) {
      for (const auto& order : program_.due(now)) {
        sender_.send(now, order.action, order.robot);
      }
    }
  }

  /// True if a vehicle is landing or down although events are left.
  [[nodiscard]] bool is_anybody_down() const {
    return left_ > 0 && std::any_of(states_.begin(), states_.end(), [this](const auto& each) {
             const bool is_down = each.second == FlightState::kLand ||
                                  each.second == FlightState::kIdle ||
                                  each.second == FlightState::kKilled;
             return is_down && program_.have_flown().contains(each.first);
           });
  }

  /// Runs the independent sequences of events; a landed vehicle flies again with all others.
  void step_lanes(Time now) {
    has_grounded_ = is_anybody_down();
    if (has_grounded_) {
      last_act_ = now;
      return;
    }
    if (const auto event = lanes_->due(now)) {
      if (do_to(now, event->what, event->robot)) {
        lanes_->happened(*event);
        program_since_ = now;
      }
    }
    if (left_ == 0 && silences_.empty() && to_seconds(now - last_act_) > kSilenceS) {
      program_.land_all();
    }
    for (const auto& order : program_.due(now)) {
      sender_.send(now, order.action, order.robot);
    }
  }

  /// Carries out the event; returns false if this is not possible at present.
  bool do_to(Time now, const std::string& what, const std::string& robot) {
    last_act_ = now;
    if (what == "hold") {
      sender_.send(now, OperatorAction::kHold, robot);
    } else if (what == "plan-loss") {
      silences_.push_back({"planner", robot, now + from_seconds(kSilenceS)});
      lanes_->rest(robot, now + from_seconds(kSilenceS + 1.5));
    } else if (!signal(what, robot)) {
      return false;
    }
    note(now, {robot}, what);
    return true;
  }

  /// Runs events that make vehicles land: each vehicle gets its event while the others fly; then
  /// all land, and the next round begins.
  void go_round(Time now) {
    const double since_s = to_seconds(now - last_act_);
    program_since_ = since_s < 90.0 ? now : program_since_;
    const bool is_down = std::all_of(states_.begin(), states_.end(), [](const auto& each) {
      return each.second == FlightState::kIdle || each.second == FlightState::kKilled;
    });
    if (is_down && cut_until_.empty() && silences_.empty() && since_s > 6.0) {
      if (left_ > 0 && unlatch_killed(now)) {
        return;
      }
      for (const std::string& robot : emptied_) {
        station_of(robot).fill_battery();
      }
      emptied_.clear();
      program_ = tools::FlightProgram(robots_);
      has_grounded_ = false;
      if (left_ == 0) {
        program_.land_all();
      }
      return;
    }
    if (left_ > 0 && what() == round_ && now >= next_victim_ && !lanes_) {
      for (const std::string& robot : robots_) {
        if (!victims_.contains(robot) && states_[robot] == FlightState::kFollow) {
          inject_event(now, robot);
          return;
        }
      }
    }
    const double until_others_land_s = round_ == "battery" ? 45.0 : 8.0;
    if (since_s > until_others_land_s && now >= next_order_) {
      for (const auto& [robot, state] : states_) {
        if (state == FlightState::kFollow || state == FlightState::kHold) {
          sender_.send(now, OperatorAction::kLand, robot);
        }
      }
      next_order_ = now + from_seconds(1.0);
    }
  }

  /// Arms vehicles in the state `killed`, which otherwise remain in that state. Returns false if
  /// there is no such vehicle.
  bool unlatch_killed(Time now) {
    bool is_there = false;
    for (const auto& [robot, state] : states_) {
      if (state == FlightState::kKilled) {
        is_there = true;
        if (now >= next_order_) {
          sender_.send(now, OperatorAction::kArm, robot);
        }
      }
    }
    next_order_ = now >= next_order_ ? now + from_seconds(1.0) : next_order_;
    return is_there;
  }

  void act(Time now) {
    program_since_ = now;
    if (what() == "hold") {
      const std::size_t chosen =
          std::uniform_int_distribution<std::size_t>(0, robots_.size())(rng_);
      held_ = chosen < robots_.size() ? robots_[chosen] : "";
      sender_.send(now, OperatorAction::kHold, held_);
      note(now, held_.empty() ? robots_ : std::vector{held_}, "hold");
      follow_at_ = now + from_seconds(kRestS);
      return;
    }
    victims_.clear();
    inject_event(now,
                 robots_[std::uniform_int_distribution<std::size_t>(0, robots_.size() - 1)(rng_)]);
  }

  void inject_event(Time now, const std::string& robot) {
    round_ = what();
    has_grounded_ = causes_landing(round_);
    last_act_ = now;
    next_victim_ = now + from_seconds(std::uniform_real_distribution<double>(0.5, 1.5)(rng_));
    victims_.insert(robot);
    if (is_shared(round_)) {
      victims_.insert(robots_.begin(), robots_.end());
    }
    if (happen(now, robot)) {
      note(now, is_shared(round_) ? robots_ : std::vector{robot}, round_);
    }
  }

  bool happen(Time now, const std::string& robot) {
    if (round_ == "plan-loss") {
      silences_.push_back({"planner", robot, now + from_seconds(kSilenceS)});
      return true;
    }
    if (is_outage(round_) || is_stall(round_)) {
      const bool is_stalled = is_stall(round_);
      silences_.push_back({is_stalled ? "quadrotor" : "vicon", is_stalled ? robot : "",
                           now + from_seconds(silence_s(round_))});
      return true;
    }
    if (round_ == "cut" || round_ == "blip") {
      const bool is_done = cut(robot, true);
      if (is_done) {
        cut_until_[robot] = now + from_seconds(round_ == "cut" ? kCutS : kBlipS);
      }
      return is_done;
    }
    if (round_ == "pilot") {
      taken_until_[robot] = now + from_seconds(kRestS);
      return station_of(robot).take_over();
    }
    if (round_ == "battery") {
      emptied_.insert(robot);
      return station_of(robot).empty_battery();
    }
    return round_ == "motor" ? station_of(robot).stop_motor() : signal(round_, robot);
  }

  /// Returns the processes of that robot; of every robot if `robot` is empty.
  static std::vector<pid_t> processes(const std::string& program, const std::string& robot) {
    return test::find_processes(
        "vantage-" + program,
        robot.empty() ? std::vector<std::string>{} : std::vector<std::string>{"--robot", robot});
  }

  /// Executes kill:PROGRAM or stop:PROGRAM. Returns false unless exactly one process matches.
  static bool signal(const std::string& what, const std::string& robot) {
    const std::string program = what.substr(5);
    const auto found = processes(program, program == "vicon" ? "" : robot);
    if (found.size() != 1) {
      std::cerr << found.size() << " processes vantage-" << program << " of " << robot << "\n";
      return false;
    }
    ::kill(found.front(), what.starts_with("kill") ? SIGKILL : SIGSTOP);
    return true;
  }

  bool cut(const std::string& robot, bool is_cut) const {
    const scenario::RobotSpec& spec = *scenario_.find_robot(robot);
    const std::string& url = spec.autopilot->url;
    const int port = std::stoi(url.substr(url.rfind(':') + 1));
    const auto driver = test::find_processes("vantage-quadrotor", {"--robot", robot});
    const bool is_px4 = spec.autopilot->dialect == models::AutopilotDialect::kPx4;
    const auto firmware = test::find_processes(
        spec.firmware->binary,
        {is_px4 ? "-i" : "--instance", std::to_string(scenario_.firmware_instance(spec))});
    const bool is_done = driver.size() == 1 && firmware.size() == 1 &&
                         test::cut_udp_link(driver.front(), firmware.front(), port, is_cut);
    if (!is_done) {
      std::cerr << "cannot " << (is_cut ? "cut" : "mend") << " the link of " << robot << " ("
                << driver.size() << " drivers, " << firmware.size() << " autopilots)\n";
    }
    return is_done;
  }

  /// Keeps the processes of each silence stopped, including restarted ones. Continues them at the
  /// end of the silence.
  void keep_silent(Time now) {
    const bool is_over = std::any_of(silences_.begin(), silences_.end(),
                                     [now](const Silence& each) { return now > each.until; });
    if (silences_.empty() || (now < next_silence_ && !is_over)) {
      return;
    }
    next_silence_ = now + from_seconds(0.1);
    program_since_ = now;
    for (const Silence& silence : silences_) {
      for (const pid_t process : processes(silence.program, silence.robot)) {
        ::kill(process, now > silence.until ? SIGCONT : SIGSTOP);
      }
    }
    std::erase_if(silences_, [now](const Silence& each) { return now > each.until; });
  }

  void mend_links(Time now) {
    std::erase_if(cut_until_, [this, now](const auto& each) {
      return now > each.second && (cut(each.first, false) || true);
    });
  }

  /// Makes the other station return the autopilots to their drivers, and commands the vehicles to
  /// follow.
  void give_back(Time now) {
    for (const auto& [robot, until] : taken_until_) {
      if (now <= until) {
        if (now >= next_keep_) {
          station_of(robot).keep();
        }
      } else {
        station_of(robot).give_back();
        held_ = robot;
        follow_at_ = now + from_seconds(kRestS);
      }
    }
    next_keep_ = now >= next_keep_ ? now + from_seconds(0.05) : next_keep_;
    std::erase_if(taken_until_, [now](const auto& each) { return now > each.second; });
  }

  test::SecondStation& station_of(const std::string& robot) {
    const scenario::RobotSpec& spec = *scenario_.find_robot(robot);
    return stations_
        .try_emplace(robot, spec.autopilot->dialect, scenario_.firmware_instance(spec),
                     spec.autopilot->system_id)
        .first->second;
  }

  /// Returns the next kind of event; the last kind when all have happened.
  [[nodiscard]] const std::string& what() const {
    const auto kinds = static_cast<int>(sequence_.size());
    return sequence_[static_cast<std::size_t>(
        std::clamp(kinds - 1 - (left_ - 1) / times_, 0, kinds - 1))];
  }

  void note(Time now, const std::vector<std::string>& robots, const std::string& what) {
    --left_;
    events_ << to_utime(now) << ' ' << what;
    for (const std::string& robot : robots) {
      events_ << ' ' << robot;
    }
    events_ << std::endl;
    std::cout << what << ", " << left_ << " to go" << std::endl;
  }

  const scenario::Scenario& scenario_;
  std::vector<std::string> sequence_;  ///< kinds, in the order in which they happen
  int times_;
  int left_;
  std::mt19937_64 rng_;
  std::ofstream events_;
  bus::SystemClock clock_;
  std::unique_ptr<bus::Transport> transport_;
  bus::Bus bus_;
  tools::OrderSender sender_;
  std::vector<std::string> robots_;
  tools::FlightProgram program_;
  Time program_since_;
  std::map<std::string, FlightState> states_;
  std::optional<Time> next_;
  std::optional<Time> follow_at_;
  std::string held_;
  std::set<std::string> victims_;
  std::string round_;  ///< last event
  std::map<std::string, Time> cut_until_;
  Time next_keep_{};
  std::map<std::string, Time> taken_until_;  ///< robots under control of the other station
  std::set<std::string> emptied_;            ///< robots with an emptied battery
  std::map<std::string, test::SecondStation> stations_;
  struct Silence {
    std::string program;
    std::string robot;
    Time until{};
  };
  std::vector<Silence> silences_;
  std::optional<test::DrillLanes> lanes_;
  bool has_grounded_ = false;
  Time last_act_{};
  Time next_victim_{};
  Time next_order_{};
  Time next_silence_{};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::cout << "usage: flight_drill SCENARIO WHAT TIMES SEED EVENTS\n";
    return 2;
  }
  const scenario::Scenario scenario = scenario::load_scenario(argv[1]);
  Drill drill(scenario, argv[2], std::atoi(argv[3]), std::strtoull(argv[4], nullptr, 10), argv[5]);
  return drill.run() ? 0 : 1;
}
