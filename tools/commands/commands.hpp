#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "scenario/reader/overrides.hpp"
#include "tools/command_line/runner.hpp"
#include "tools/view/web_server.hpp"

namespace vantage::tools {

// Each adds one subcommand to `root`, which sets `run` when it is chosen.
void add_trial_command(CLI::App& root, Runner& run);
void add_demo_command(CLI::App& root, Runner& run);
void add_up_command(CLI::App& root, Runner& run);
void add_check_command(CLI::App& root, Runner& run);
void add_config_command(CLI::App& root, Runner& run);
void add_console_command(CLI::App& root, Runner& run);
void add_plan_command(CLI::App& root, Runner& run);
void add_doctor_command(CLI::App& root, Runner& run);
void add_experiment_command(CLI::App& root, Runner& run);
void add_view_command(CLI::App& root, Runner& run);
void add_keys_command(CLI::App& root, Runner& run);
void add_log_command(CLI::App& root, Runner& run);

/// --seed, --duration-s, --planner, --communication-range-m and --nodes, shared by all that run a
/// trial.
void add_override_options(CLI::App& command, scenario::Overrides& overrides);
/// --port and --bind of what is shown in the browser.
void add_web_options(CLI::App& command, WebOptions& web);
/// Prints where to look.
void announce_view(const WebServer& server, const std::string& what);

}  // namespace vantage::tools
