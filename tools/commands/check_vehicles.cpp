#include "tools/commands/check_vehicles.hpp"

#include <array>
#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "bus/node/clock.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "drivers/quadrotor/app/node.hpp"
#include "drivers/vehicle/port.hpp"
#include "tools/check/vehicle_check.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

constexpr auto kPause = std::chrono::milliseconds(5);
constexpr int kReadsMax = 64;  // maximum number of consecutive reads per vehicle

struct Vehicle {
  std::unique_ptr<drivers::Port> port;
  std::unique_ptr<VehicleCheck> check;
  std::array<std::uint8_t, 2048> buffer{};

  void turn(Time now) {
    for (int i = 0; i < kReadsMax; ++i) {
      const std::size_t got = port->read(buffer, now);
      if (got == 0) {
        break;
      }
      if (check->receive({buffer.data(), got}, port->is_datagram(), now)) {
        port->accept(now);
      }
    }
    check->tick(now);
    for (const drivers::WireMessage& message : check->take_output()) {
      port->write(message, now);
    }
  }
};

std::vector<Vehicle> open(const scenario::Scenario& scenario, const std::string& only, Time now) {
  std::vector<Vehicle> out;
  for (const scenario::RobotSpec* robot : robots_with_autopilot(scenario)) {
    if (!only.empty() && robot->name != only) {
      continue;
    }
    Vehicle vehicle;
    vehicle.port = drivers::open_port(robot->autopilot->url);
    vehicle.check =
        std::make_unique<VehicleCheck>(*robot, drivers::load_key(robot->autopilot->key_file), now);
    out.push_back(std::move(vehicle));
  }
  if (out.empty()) {
    throw StartupError(only.empty()
                           ? "no robot of this scenario has `autopilot: {url: …}`"
                           : "robot " + only + " has no `autopilot: {url: …}` in this scenario");
  }
  return out;
}

/// Runs the checks until each vehicle's parameters are read or have failed, or until Ctrl-C.
void run_checks(std::vector<Vehicle>& vehicles, const bus::Clock& clock, bool shows_progress) {
  Screen screen;
  bool is_done = false;
  while (!is_done && !stop_requested()) {
    is_done = true;
    std::vector<std::string> progress;
    for (Vehicle& vehicle : vehicles) {
      const Time now = clock.now();
      vehicle.turn(now);
      is_done = is_done && vehicle.check->is_done(now);
      progress.push_back(fmt::format("{}: {} of {} parameters", vehicle.check->robot(),
                                     vehicle.check->settled(), vehicle.check->size()));
    }
    if (shows_progress) {
      screen.redraw(is_done ? std::vector<std::string>() : progress);
    }
    std::this_thread::sleep_for(kPause);
  }
}

bool is_confirmed(std::size_t differences) {
  if (isatty(STDIN_FILENO) == 0) {
    throw StartupError(
        "--load cannot ask for confirmation: standard input is not a terminal; add --yes");
  }
  fmt::print("write {} parameters? Remove the propellers first. [y/N] ", differences);
  std::cout.flush();
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

nlohmann::ordered_json to_json(const VehicleCheck& check, Time now) {
  nlohmann::ordered_json out{{"robot", check.robot()},
                             {"autopilot", name_of(check.dialect())},
                             {"ready", check.is_ready(now)},
                             {"parameters", check.size()}};
  if (const auto fault = check.fault(now)) {
    out["fault"] = *fault;
    return out;
  }
  out["differences"] = nlohmann::ordered_json::array();
  for (const auto& [rule, actual, is_settled] : check.differences()) {
    nlohmann::ordered_json one{{"name", rule.name}, {"is", nullptr}};
    if (actual) {
      one["is"] = *actual;
    }
    one["wanted"] = rule.requirement_text();
    one["otherwise"] = rule.effect;
    one["advised"] = rule.is_advised;
    out["differences"].push_back(std::move(one));
  }
  return out;
}

void print_all(const std::vector<Vehicle>& vehicles, Time now) {
  for (const Vehicle& vehicle : vehicles) {
    for (const std::string& line : describe(*vehicle.check, now)) {
      print_line(line);
    }
  }
}

}  // namespace

VehicleReport check_vehicles(const scenario::Scenario& scenario,
                             const VehicleCheckOptions& options) {
  const bus::SystemClock clock;
  std::vector<Vehicle> vehicles = open(scenario, options.robot, clock.now());
  const bool shows_progress = !options.is_quiet && is_terminal();
  run_checks(vehicles, clock, shows_progress);
  std::size_t differences = 0;
  for (const Vehicle& vehicle : vehicles) {
    const bool is_read = !vehicle.check->fault(clock.now());
    differences += is_read ? vehicle.check->differences().size() : 0;
  }
  if (options.is_load && differences > 0) {
    if (!options.is_quiet) {
      print_all(vehicles, clock.now());
    }
    if (options.skips_confirmation || is_confirmed(differences)) {
      for (Vehicle& vehicle : vehicles) {
        if (!vehicle.check->fault(clock.now())) {
          vehicle.check->load();
        }
      }
      run_checks(vehicles, clock, shows_progress);
      if (!options.is_quiet) {
        print_line("parameters written and read back; restart the autopilots, then check again:");
      }
    }
  }
  const Time now = clock.now();
  if (!options.is_quiet) {
    print_all(vehicles, now);
  }
  VehicleReport out{nlohmann::ordered_json::array(), true};
  for (const Vehicle& vehicle : vehicles) {
    out.vehicles.push_back(to_json(*vehicle.check, now));
    out.is_ready = out.is_ready && vehicle.check->is_ready(now);
  }
  return out;
}

}  // namespace vantage::tools
