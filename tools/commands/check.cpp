#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/publisher_watch.hpp"
#include "bus/transport/transport.hpp"
#include "core/process.hpp"
#include "core/utf8.hpp"
#include "logs/file/wire_check.hpp"
#include "logs/record/append_file.hpp"
#include "logs/record/log_space.hpp"
#include "scenario/reader/mistakes.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "tools/check/arming_watch.hpp"
#include "tools/check/preflight.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/check_vehicles.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct CheckArguments {
  std::string scenario;
  std::string log_path;
  bool as_json = false;
  bool is_live = false;
  double listen_s = 2.0;
  bool is_of_vehicles = false;
  VehicleCheckOptions vehicles;
};

/// Listens to the running system and appends the reasons that prevent arming. `authenticator`:
/// nullptr without security.
void listen(const scenario::Scenario& scenario, double listen_s,
            std::unique_ptr<bus::auth::Authenticator> authenticator,
            std::vector<std::string>& faults) {
  const auto transport = bus::open_transport(scenario.network.url);
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SteadyClock clock;
  bus.use_clock(clock);
  bus.secure(std::move(authenticator), clock);
  const ArmingWatch watch(bus, scenario);
  const auto raw = bus::open_transport(scenario.network.url);
  bus::PublisherWatch publishers;
  raw->subscribe("*", [&](std::string_view channel, const bus::Payload& bytes) {
    if (logs::type_of(bytes) != nullptr) {
      publishers.on_run(channel, bus::run_id_of(bytes));
    }
  });
  const Time end = clock.now() + from_seconds(listen_s);
  while (clock.now() < end && !stop_requested()) {
    bus.handle(std::chrono::milliseconds(20));
    raw->handle(std::chrono::milliseconds(0));
  }
  for (const std::string& block : watch.blocks()) {
    faults.push_back(block);
  }
  for (const std::string& channel : publishers.contested()) {
    faults.push_back(fmt::format(
        "{}: two processes publish; end one of them, or set `device: external` if yours replaces a "
        "process of vantage",
        readable(channel)));
  }
}

std::string security_words(const scenario::Scenario& scenario) {
  const std::string mode = name_of(scenario::trial_mode(scenario));
  switch (scenario.security.mode) {
    case scenario::SecurityMode::kOff:
      return "messages are not signed: every message on the network is accepted";
    case scenario::SecurityMode::kWarn:
      return "messages are signed (" + mode +
             "); messages without a valid signature are counted but accepted";
    case scenario::SecurityMode::kRequire:
      return "messages are signed (" + mode + "); messages without a valid signature are rejected";
  }
  return "";
}

int run_vehicles(const CheckArguments& arguments) {
  const scenario::Scenario scenario = scenario::load_scenario(arguments.scenario);
  VehicleCheckOptions options = arguments.vehicles;
  options.is_quiet = arguments.as_json;
  const VehicleReport report = check_vehicles(scenario, options);
  if (arguments.as_json) {
    print_json(nlohmann::ordered_json{{"scenario", arguments.scenario},
                                      {"ready", report.is_ready},
                                      {"vehicles", report.vehicles}});
  } else {
    print_line(report.is_ready ? "ready" : "not ready");
  }
  return report.is_ready ? 0 : 1;
}

/// Exit code for a scenario that cannot be read.
constexpr int kUnreadable = 2;
constexpr std::size_t kMistakesShown = 10;

int run(const CheckArguments& arguments) {
  if (const auto mistakes = scenario::mistakes_of_scenario(arguments.scenario);
      mistakes.size() > 1) {
    for (std::size_t i = 0; i < std::min(mistakes.size(), kMistakesShown); ++i) {
      print_line("vantage: " + mistakes[i], stderr);
    }
    print_line(
        fmt::format("{} mistakes{}; some may follow from others", mistakes.size(),
                    mistakes.size() > kMistakesShown ? ", of which the first are shown" : ""),
        stderr);
    return kUnreadable;
  }
  if (arguments.is_of_vehicles) {
    return run_vehicles(arguments);
  }
  const scenario::Scenario scenario = scenario::load_scenario(arguments.scenario);
  Preflight preflight = check_preflight(scenario);
  const std::string log_path =
      arguments.log_path.empty() ? scenario.name + ".lcmlog" : arguments.log_path;
  const logs::LogSpaceCheck space =
      logs::check_log_space(scenario, log_path, logs::free_bytes_for(log_path));
  (space.is_enough ? preflight.understood : preflight.faults).push_back(space.summary);
  preflight.understood.push_back(security_words(scenario));
  std::vector<std::string> security_faults = bus::auth::security_faults(scenario);
  const bool can_judge = security_faults.empty();
  std::ranges::move(security_faults, std::back_inserter(preflight.faults));
  const MemoryCheck memory = check_planner_memory(scenario, free_memory_bytes());
  (memory.is_enough ? preflight.understood : preflight.faults).push_back(memory.summary);
  if (arguments.is_live && can_judge) {
    listen(scenario, arguments.listen_s, bus::auth::authenticator_for(scenario), preflight.faults);
  }
  if (arguments.as_json) {
    print_json(nlohmann::ordered_json{{"scenario", arguments.scenario},
                                      {"ready", preflight.is_ready()},
                                      {"understood", preflight.understood},
                                      {"faults", preflight.faults},
                                      {"notes", preflight.notes}});
  } else {
    for (const std::string& line : preflight.understood) {
      print_line(line);
    }
    for (const std::string& note : preflight.notes) {
      print_line("note: " + note);
    }
    for (const std::string& fault : preflight.faults) {
      print_line(arguments.scenario + ": " + fault, stderr);
    }
    print_line(preflight.is_ready() ? "ready" : "not ready");
  }
  return preflight.is_ready() ? 0 : 1;
}

}  // namespace

void add_check_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand("check", "Check whether a scenario is ready to fly.");
  auto arguments = std::make_shared<CheckArguments>();
  add_scenario_option(*command, arguments->scenario);
  command->add_option("--log", arguments->log_path,
                      "log file that `vantage up` will write; its disk must have enough free space "
                      "(default: NAME.lcmlog in this folder)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->add_flag("--live", arguments->is_live,
                    "also listen to the running system and list what prevents arming; skipped if "
                    "required security keys are missing");
  command->add_option("--listen", arguments->listen_s, "seconds to listen with --live (default: 2)")
      ->needs("--live")
      ->check(number_between(0.0, 3600.0));
  CLI::Option* const vehicles = command->add_flag(
      "--vehicles", arguments->is_of_vehicles,
      "read each autopilot's parameters and list differences from config/autopilot; "
      "arms nothing; stop all drivers first");
  vehicles->excludes("--live");
  command
      ->add_option("--robot", arguments->vehicles.robot, "with --vehicles: check only this robot")
      ->needs(vehicles);
  CLI::Option* const load =
      command
          ->add_flag("--load", arguments->vehicles.is_load,
                     "write the required values after confirmation, and read them back")
          ->needs(vehicles);
  command
      ->add_flag("--yes", arguments->vehicles.skips_confirmation,
                 "with --load: write without confirmation")
      ->needs(load);
  command->footer(
      "Exit code 0: ready; 1: not ready, with the reasons; 2: the scenario cannot be read.\n"
      "Example:\n"
      "  vantage check config/lab.yaml\n"
      "  vantage check config/lab.yaml --live\n"
      "  vantage check config/lab-mixed.yaml --vehicles --load");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
