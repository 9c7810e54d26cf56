#include "tools/up/up.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "logs/record/append_file.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/report.hpp"
#include "tools/live/screen.hpp"
#include "tools/up/process_plan.hpp"
#include "tools/up/up_report.hpp"

namespace vantage::tools {
namespace {

struct UpArguments {
  std::string scenario;
  scenario::Overrides overrides;
  std::string host;
  bool all_hosts = false;
  std::string log_path;
  std::string log_folder;
  bool no_log = false;
  int log_sync_ms = 40;
  bool fly = false;
  bool ignore_others = false;
  bool ignore_load = false;
  bool has_virtual_targets = false;
  bool as_json = false;
  RestartPolicy restarts;
};

void check_host(const scenario::Scenario& scenario, const UpArguments& arguments) {
  std::vector<std::string> names;
  for (const scenario::HostSpec& host : scenario.hosts) {
    names.push_back(host.name);
  }
  if (arguments.host.empty()) {
    if (!names.empty() && !arguments.all_hosts) {
      throw StartupError(fmt::format(
          "{} has the hosts {}: name this one with --host, or run all of them here with "
          "--all-hosts",
          arguments.scenario, fmt::join(names, ", ")));
    }
    return;
  }
  if (std::find(names.begin(), names.end(), arguments.host) == names.end()) {
    throw StartupError(fmt::format(
        "--host must be one of the hosts of {} ({}), is '{}'", arguments.scenario,
        names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")), arguments.host));
  }
}

std::string log_path(const scenario::Scenario& scenario, const UpArguments& arguments) {
  const bool is_named = !arguments.log_path.empty() || !arguments.log_folder.empty();
  const bool runs_logger =
      arguments.host.empty() || scenario.runs_on(arguments.host, scenario::kLoggerPart);
  if (is_named && !runs_logger) {
    throw StartupError(
        "host " + arguments.host +
        " does not run the logger; use the log option on the host that has `logger` in `hosts`");
  }
  if (arguments.no_log || !runs_logger) {
    return "";
  }
  if (!arguments.log_folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(arguments.log_folder, error);
    const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    return logs::unused_path(fmt::format("{}/{}-{:%Y%m%dT%H%M%SZ}.lcmlog", arguments.log_folder,
                                         scenario.name, fmt::gmtime(now)));
  }
  return arguments.log_path.empty() ? logs::unused_path(scenario.name + ".lcmlog")
                                    : arguments.log_path;
}

int run(const UpArguments& arguments) {
  const scenario::Scenario scenario =
      scenario::load_scenario_with(arguments.scenario, arguments.overrides);
  check_host(scenario, arguments);
  UpOptions options;
  options.executables = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
  options.quiet = arguments.as_json;
  options.live_table = is_terminal() && !options.quiet;
  options.fly = arguments.fly;
  // If vehicles have drivers, the flight ends after a duration only if the user has given one.
  options.ends_by_duration =
      arguments.overrides.duration_s.has_value() || robots_with_driver(scenario).empty();
  options.ignore_others = arguments.ignore_others;
  options.ignore_load = arguments.ignore_load;
  options.has_virtual_targets = arguments.has_virtual_targets;
  options.host = arguments.host;
  options.log_path = log_path(scenario, arguments);
  if (!options.log_path.empty()) {
    const std::filesystem::path log(options.log_path);
    options.firmware_folder = (log.parent_path() / log.stem()).string() + "-firmware";
  }
  options.log_sync_ms = arguments.log_sync_ms;
  options.restarts = arguments.restarts;
  options.stop_requests = stop_requests;
  const UpResult result = run_up(scenario, options, stop_requested);
  if (arguments.as_json) {
    clear_echo();
    print_json(to_json(result));
  } else {
    report_summary(scenario, result.summary, false);
    if (!options.log_path.empty()) {
      print_line("log      " + options.log_path);
    }
  }
  for (const std::string& remark : remarks(result)) {
    print_line("vantage: " + remark, stderr);
  }
  return is_good(result) ? 0 : 1;
}

void add_restart_options(CLI::App& command, RestartPolicy& restarts) {
  command
      .add_option("--restarts-max", restarts.restarts_max,
                  "maximum number of restarts of one process within --restart-window-s; a process "
                  "that fails more often is not restarted")
      ->check(non_negative_number())
      ->capture_default_str();
  command
      .add_option("--restart-window-s", restarts.window_s,
                  "period over which restarts are counted, s")
      ->check(positive_number())
      ->capture_default_str();
  command
      .add_option("--backoff-first-s", restarts.backoff_first_s,
                  "wait before the first restart, s; doubled at each failure; back to this value "
                  "after a run of 10 s")
      ->check(non_negative_number())
      ->capture_default_str();
  command.add_option("--backoff-max-s", restarts.backoff_max_s, "longest wait before a restart, s")
      ->check(non_negative_number())
      ->capture_default_str();
}

}  // namespace

// Long function: it adds the options one by one.
void add_up_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "up", "Run, restart and record all processes of a scenario on this host.");
  auto arguments = std::make_shared<UpArguments>();
  add_scenario_option(*command, arguments->scenario);
  add_override_options(*command, arguments->overrides);
  command->add_option("--url", arguments->overrides.url, "LCM URL (default: the scenario's)");
  auto* host = command->add_option(
      "--host", arguments->host,
      "run only the processes that `hosts` in the scenario assigns to this host");
  command
      ->add_flag("--all-hosts", arguments->all_hosts,
                 "run the processes of all hosts of the scenario here")
      ->excludes(host);
  auto* log =
      command->add_option("--log", arguments->log_path,
                          "new file for the log (default: NAME.lcmlog, or NAME-2.lcmlog and "
                          "so on if that file exists)");
  auto* folder = command->add_option("--log-folder", arguments->log_folder,
                                     "folder for a new log with the name NAME-TIME.lcmlog");
  folder->excludes(log);
  command->add_flag("--no-log", arguments->no_log, "do not write a log")
      ->excludes(log)
      ->excludes(folder);
  command
      ->add_option("--log-sync-ms", arguments->log_sync_ms,
                   "pause between two syncs of the log to the disk, ms; a power cut loses up to "
                   "twice this time; larger values wear an SD card less")
      ->capture_default_str()
      ->check(CLI::Range(1, 60'000));
  command->add_flag("--fly", arguments->fly,
                    "act as the operator: arm, take off, follow, and land at the end");
  command->add_flag(
      "--ignore-others", arguments->ignore_others,
      "start even if another supervisor, a simulator or vehicles are active on the network");
  command->add_flag("--ignore-load", arguments->ignore_load,
                    "with --fly: fly even if this host is busy and denies real-time priority to "
                    "drivers");
  command->add_flag("--virtual-targets", arguments->has_virtual_targets,
                    "simulate the targets even if all devices are real");
  add_restart_options(*command, arguments->restarts);
  command->add_flag("--json", arguments->as_json,
                    "print one JSON object at the end; events are printed to stderr");
  command->footer(
      "Without --fly, real robots and robots simulated behind their protocol wait for `vantage\n"
      "console`.\n"
      "End: Ctrl-C, SIGTERM or --duration-s. The scenario's duration also ends the trial if no\n"
      "vehicle has a driver. Vehicles in flight are landed first, within 60 s; a second Ctrl-C\n"
      "leaves the landing to their autopilots. Then all processes end within 2 s; one more Ctrl-C\n"
      "kills them at once and still completes the log.\n"
      "Restarts: a process that fails is restarted. The trial ends if the simulator or the mocap\n"
      "driver fails too often, and continues without any other process. The driver of a vehicle\n"
      "in flight is restarted without limit.\n"
      "Exit code 1: a collision; a process was killed or failed too often; the simulator was\n"
      "restarted (robots and targets return to their starts); the log is incomplete;\n"
      "another host flew another scenario; a vehicle was still in flight at the end; a robot of\n"
      "--fly did not fly; or an internal error. Exit code 2: could not start.\n"
      "Examples:\n"
      "  vantage up config/lab.yaml\n"
      "  vantage up config/lab.yaml --duration-s 60 --log flight.lcmlog\n"
      "  vantage up config/lab-hil.yaml --fly\n"
      "  vantage up trial.yaml --host AIR --log-folder /var/log/vantage\n"
      "  vantage up config/lab.yaml --url 'udpm://239.255.76.67:7700?ttl=1' --no-log");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
