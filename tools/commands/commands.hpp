#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <CLI/CLI.hpp>

#include "scenario/reader/overrides.hpp"
#include "tools/command_line/runner.hpp"
#include "tools/view/web_server.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::tools {

// Each function adds one subcommand to `root`. The subcommand sets `run` when it is chosen.
void add_trial_command(CLI::App& root, Runner& run);
void add_demo_command(CLI::App& root, Runner& run);
void add_up_command(CLI::App& root, Runner& run);
void add_check_command(CLI::App& root, Runner& run);
void add_config_command(CLI::App& root, Runner& run);
void add_console_command(CLI::App& root, Runner& run);
void add_plan_command(CLI::App& root, Runner& run);
void add_python_command(CLI::App& root, Runner& run);
void add_doctor_command(CLI::App& root, Runner& run);
void add_experiment_command(CLI::App& root, Runner& run);
void add_ros2_command(CLI::App& root, Runner& run);
void add_view_command(CLI::App& root, Runner& run);
void add_keys_command(CLI::App& root, Runner& run);
void add_log_command(CLI::App& root, Runner& run);

/// Makes `command` call `run(*arguments)` after it has resolved arguments->scenario by
/// trial::scenario_path().
template <class Arguments>
void run_on_scenario(CLI::App& command, Runner& chosen, std::shared_ptr<Arguments> arguments,
                     int (*run)(const std::type_identity_t<Arguments>&)) {
  command.callback([&chosen, arguments, run] {
    chosen = [arguments, run] {
      arguments->scenario = trial::scenario_path(arguments->scenario);
      return run(*arguments);
    };
  });
}

/// Adds the required argument `scenario` for run_on_scenario().
void add_scenario_option(CLI::App& command, std::string& scenario);
/// Adds --seed, --duration-s, --planner, --communication-range-m and --nodes, which all commands
/// that run a trial share. Unless `planners` is null, --planner is a list of names, which is stored
/// in `planners`.
void add_override_options(CLI::App& command, scenario::Overrides& overrides,
                          std::vector<std::string>* planners = nullptr);
/// Adds the options of the web server: --port, --bind, --host, --origin and --page.
void add_web_options(CLI::App& command, WebOptions& web);
/// Prints the address of the viewer.
void announce_view(const WebServer& server, const std::string& what);

}  // namespace vantage::tools
