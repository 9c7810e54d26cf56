#include "tools/up/up.hpp"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "core/process.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/report.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct UpArguments {
  std::string scenario;
  Overrides overrides;
  std::string log_path;
  bool no_log = false;
  bool fly = false;
  bool has_virtual_targets = false;
  bool as_json = false;
};

int run(const UpArguments& arguments) {
  const models::Scenario scenario = load_scenario_with(arguments.scenario, arguments.overrides);
  UpOptions options;
  options.executables = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
  options.quiet = arguments.as_json;
  options.fly = arguments.fly;
  options.has_virtual_targets = arguments.has_virtual_targets;
  if (!arguments.no_log) {
    options.log_path = arguments.log_path.empty() ? scenario.name + ".lcmlog" : arguments.log_path;
  }
  const UpResult result = run_up(scenario, options, stop_requested);
  report_summary(scenario, result.summary, arguments.as_json);
  if (!arguments.as_json && !options.log_path.empty()) {
    print_line("log      " + options.log_path);
  }
  for (const std::string& name : result.killed) {
    fmt::print(stderr, "vantage: {} did not end by itself and was killed\n", name);
  }
  if (result.restarts > 0) {
    fmt::print(stderr, "vantage: {} restarts\n", result.restarts);
  }
  for (const std::string& name : result.never_flown) {
    fmt::print(stderr, "vantage: {} has never followed a plan\n", name);
  }
  for (const std::string& name : result.left_flying) {
    fmt::print(stderr, "vantage: {} had not landed when its driver was ended\n", name);
  }
  const bool is_good = !result.any_given_up && result.killed.empty() &&
                       result.never_flown.empty() && result.left_flying.empty() &&
                       result.summary.collisions == 0;
  return is_good ? 0 : 1;
}

}  // namespace

void add_up_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "up", "Run every process of a scenario on this host, supervised and recorded.");
  auto arguments = std::make_shared<UpArguments>();
  command->add_option("scenario", arguments->scenario, "scenario file")->required();
  add_override_options(*command, arguments->overrides);
  command->add_option("--url", arguments->overrides.url, "LCM URL instead of the scenario's");
  auto* log = command->add_option("--log", arguments->log_path,
                                  "where lcm-logger writes; NAME.lcmlog when not given");
  command->add_flag("--no-log", arguments->no_log, "do not record")->excludes(log);
  command->add_flag("--fly", arguments->fly,
                    "be the operator: arm, take off, follow, and land at the end");
  command->add_flag("--virtual-targets", arguments->has_virtual_targets,
                    "simulate the targets though every device is real");
  command->add_flag("--json", arguments->as_json, "print one JSON object at the end");
  command->footer(
      "Ends after the scenario's duration or with Ctrl-C; all processes are gone 2 s later. With\n"
      "--fly both mean: land everything first. Without it robots on the wire and real ones wait "
      "for\n"
      "`vantage console`.\n"
      "Exit code 1 when a process had to be given up or killed, anything collided, or a robot of\n"
      "--fly did not fly or did not land.\n"
      "Examples:\n"
      "  vantage up config/lab.yaml\n"
      "  vantage up config/lab.yaml --duration-s 60 --log flight.lcmlog\n"
      "  vantage up config/lab-hil.yaml --fly\n"
      "  vantage up config/lab.yaml --url 'udpm://239.255.76.67:7700?ttl=1' --no-log");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
