// flight_drill SCENARIO WHAT TIMES SEED EVENTS
//
// The operator of a flight that `vantage up` runs: arms everybody, has them follow, and then, TIMES
// times in all and at seeded moments while all follow, does WHAT to one vehicle:
//
//   hold            says `hold`, and `follow` again after 2.5 s; one time in four to all
//   plan-loss       SIGSTOP of its planner, and of those that are started again, for 8 s
//   cut             cuts its MAVLink link both ways, until it is down
//   kill:PROGRAM    kill -9, stop:PROGRAM SIGSTOP, of a process of `up`: planner, estimator,
//   sensor,
//                   quadrotor (each of that vehicle), vicon (everybody's)
//
// Several of them, parted by commas and without `cut`, `quadrotor` and `vicon`: each TIMES times,
// to every vehicle on its own, so that much happens in a short flight.
//
// Vehicles that came down are flown again. EVENTS gets a line "µs WHAT ROBOT…" each time; what
// became of it is in the log (hil_check --events EVENTS LOG). Exit code 0 when all was done and all
// came down.

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
#include "tools/console/console.hpp"
#include "tools/up/flight_program.hpp"
#include "tools/up/process_plan.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a test's main alone
using models::FlightState;
using models::OperatorAction;

constexpr double kRestS = 2.5;
constexpr double kSilenceS = 8.0;
constexpr double kGiveUpS = 150.0;

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    out.push_back(word);
  }
  return out;
}

class Drill {
 public:
  Drill(const scenario::Scenario& scenario, std::string what, int times, std::uint64_t seed,
        const std::string& events)
      : scenario_(scenario),
        what_(std::move(what)),
        left_(times * static_cast<int>(words_of(what_).size())),
        rng_(seed),
        events_(events),
        transport_(bus::open_transport(scenario.network.url)),
        bus_(*transport_, bus::random_run_id()),
        desk_(bus_, false, clock_.now()),
        robots_(tools::robots_with_driver(scenario)),
        program_(robots_),
        program_since_(clock_.now()) {
    if (what_.find(',') != std::string::npos) {
      lanes_.emplace(words_of(what_), times, seed);
    }
    bus_.subscribe<models::VehicleStatus>(bus::quadrotor_channel("*"),
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
      desk_.tick(now);
      if (!desk_.station().beats()) {
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
    mend_links();
    silence_planners(now);
    if (has_grounded_) {
      go_round(now);
      return;
    }
    if (lanes_) {
      step_lanes(now);
      return;
    }
    if (follow_at_ && now >= *follow_at_) {
      desk_.send(now, OperatorAction::kFollow, held_);
      follow_at_.reset();
      program_since_ = now;
    } else if (next_ && now >= *next_) {
      next_.reset();
      act(now);
    } else if (!next_ && !follow_at_ && silent_until_.empty() && all(FlightState::kFollow)) {
      if (left_ == 0) {
        program_.bring_down();
      } else {
        next_ = now + from_seconds(std::uniform_real_distribution<double>(1.5, 4.0)(rng_));
      }
    }
    if (!follow_at_) {
      for (const auto& order : program_.due(now)) {
        desk_.send(now, order.action, order.robot);
      }
    }
  }

  /// Each vehicle on its own; one that came down for it is flown again with the others.
  void step_lanes(Time now) {
    has_grounded_ = std::any_of(states_.begin(), states_.end(), [this](const auto& each) {
      const bool is_down = each.second == FlightState::kLand || each.second == FlightState::kIdle ||
                           each.second == FlightState::kKilled;
      return is_down && program_.have_flown().contains(each.first) && left_ > 0;
    });
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
    if (left_ == 0 && silent_until_.empty() && to_seconds(now - last_act_) > kSilenceS) {
      program_.bring_down();
    }
    for (const auto& order : program_.due(now)) {
      desk_.send(now, order.action, order.robot);
    }
  }

  /// False when it could not be done now.
  bool do_to(Time now, const std::string& what, const std::string& robot) {
    last_act_ = now;
    if (what == "hold") {
      desk_.send(now, OperatorAction::kHold, robot);
    } else if (what == "plan-loss") {
      silent_until_[robot] = now + from_seconds(kSilenceS);
      lanes_->rest(robot, now + from_seconds(kSilenceS + 1.5));
    } else if (!signal(what, robot)) {
      return false;
    }
    note(now, {robot}, what);
    return true;
  }

  /// What makes them land: each has its event while the others fly; then all come down, to begin
  /// anew.
  void go_round(Time now) {
    program_since_ = to_seconds(now - last_act_) < 90.0 ? now : program_since_;
    if (all(FlightState::kIdle) && cut_.empty() && to_seconds(now - last_act_) > 6.0) {
      program_ = tools::FlightProgram(robots_);
      has_grounded_ = false;
      if (left_ == 0) {
        program_.bring_down();
      }
      return;
    }
    if (left_ > 0 && now >= next_victim_ && !lanes_) {
      for (const std::string& robot : robots_) {
        if (!victims_.contains(robot) && states_[robot] == FlightState::kFollow) {
          strike(now, robot);
          return;
        }
      }
    }
    if (to_seconds(now - last_act_) > 8.0 && now >= next_order_) {
      for (const auto& [robot, state] : states_) {
        if (state == FlightState::kFollow || state == FlightState::kHold) {
          desk_.send(now, OperatorAction::kLand, robot);
        }
      }
      next_order_ = now + from_seconds(1.0);
    }
  }

  void act(Time now) {
    program_since_ = now;
    if (what_ == "hold") {
      const std::size_t chosen =
          std::uniform_int_distribution<std::size_t>(0, robots_.size())(rng_);
      held_ = chosen < robots_.size() ? robots_[chosen] : "";
      desk_.send(now, OperatorAction::kHold, held_);
      note(now, held_.empty() ? robots_ : std::vector{held_}, what_);
      follow_at_ = now + from_seconds(kRestS);
      return;
    }
    victims_.clear();
    strike(now, robots_[std::uniform_int_distribution<std::size_t>(0, robots_.size() - 1)(rng_)]);
  }

  void strike(Time now, const std::string& robot) {
    has_grounded_ = what_ == "cut" || what_.ends_with("quadrotor") || what_.ends_with("vicon");
    last_act_ = now;
    next_victim_ = now + from_seconds(std::uniform_real_distribution<double>(0.5, 1.5)(rng_));
    victims_.insert(robot);
    if (what_ == "plan-loss") {
      silent_until_[robot] = now + from_seconds(kSilenceS);
      note(now, {robot}, what_);
      return;
    }
    if (what_ == "cut") {
      if (cut(robot, true)) {
        cut_.insert(robot);
        note(now, {robot}, what_);
      }
      return;
    }
    if (!signal(what_, robot)) {
      return;
    }
    const bool is_shared = what_.ends_with("vicon");
    if (is_shared) {
      victims_.insert(robots_.begin(), robots_.end());
    }
    note(now, is_shared ? robots_ : std::vector{robot}, what_);
  }

  /// kill:PROGRAM or stop:PROGRAM; false when there is not one such process.
  static bool signal(const std::string& what, const std::string& robot) {
    const std::string program = what.substr(5);
    const auto found = test::find_processes(
        "vantage-" + program, program == "vicon" ? std::vector<std::string>{}
                                                 : std::vector<std::string>{"--robot", robot});
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
    const auto instance =
        std::distance(robots_.begin(), std::find(robots_.begin(), robots_.end(), robot));
    const bool is_px4 = spec.autopilot->dialect == models::AutopilotDialect::kPx4;
    const auto firmware = test::find_processes(
        spec.firmware->binary, {is_px4 ? "-i" : "--instance", std::to_string(instance)});
    const bool is_done = driver.size() == 1 && firmware.size() == 1 &&
                         test::cut_udp_link(driver.front(), firmware.front(), port, is_cut);
    if (!is_done) {
      std::cerr << "cannot " << (is_cut ? "cut" : "mend") << " the link of " << robot << " ("
                << driver.size() << " drivers, " << firmware.size() << " autopilots)\n";
    }
    return is_done;
  }

  void silence_planners(Time now) {
    std::erase_if(silent_until_, [now](const auto& each) { return now > each.second; });
    if (!silent_until_.empty() && now >= next_silence_) {
      for (const auto& [robot, until] : silent_until_) {
        for (const pid_t planner : test::find_processes("vantage-planner", {"--robot", robot})) {
          ::kill(planner, SIGSTOP);
        }
      }
      next_silence_ = now + from_seconds(0.1);
      program_since_ = now;
    }
  }

  /// Links are mended when nobody has moved for long: by then it has landed.
  void mend_links() {
    if (!cut_.empty() && to_seconds(clock_.now() - last_act_) > 16.0) {
      for (const std::string& robot : cut_) {
        cut(robot, false);
      }
      cut_.clear();
    }
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
  std::string what_;
  int left_;
  std::mt19937_64 rng_;
  std::ofstream events_;
  bus::SystemClock clock_;
  std::unique_ptr<bus::Transport> transport_;
  bus::Bus bus_;
  tools::OperatorDesk desk_;
  std::vector<std::string> robots_;
  tools::FlightProgram program_;
  Time program_since_;
  std::map<std::string, FlightState> states_;
  std::optional<Time> next_;
  std::optional<Time> follow_at_;
  std::string held_;
  std::set<std::string> victims_;
  std::set<std::string> cut_;
  std::map<std::string, Time> silent_until_;  ///< whose planners are stopped
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
