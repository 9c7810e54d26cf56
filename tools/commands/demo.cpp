#include "tools/live/demo.hpp"

#include <memory>

#include "core/process.hpp"
#include "tools/commands/commands.hpp"
#include "tools/commands/report.hpp"
#include "tools/live/screen.hpp"
#include "tools/view/live_view.hpp"
#include "trial/recipe.hpp"
#include "trial/robot_processes.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::tools {
namespace {

struct DemoArguments {
  std::string scenario;  ///< empty: the scenario `lab` that is supplied with vantage
  std::string directory = "demo-out";
  scenario::Overrides overrides;
  bool as_json = false;
  bool is_shown = false;
  WebOptions web;
};

int run(const DemoArguments& arguments) {
  scenario::Overrides overrides = arguments.overrides;
  if (!overrides.duration_s) {
    overrides.duration_s = 60.0;
  }
  const scenario::Scenario scenario = scenario::load_scenario_with(
      arguments.scenario.empty() ? trial::config_path("lab") : arguments.scenario, overrides);
  DemoOptions options;
  options.directory = arguments.directory;
  options.quiet = arguments.as_json;
  options.live_table = is_terminal() && !options.quiet;
  options.warn = [](const std::string& words) { print_line("! " + words, stderr); };
  if (arguments.is_shown) {
    options.attach = [&](bus::InProcessHub& hub) {
      auto view = std::make_shared<LiveView>(hub.connect(), arguments.web);
      if (!arguments.as_json) {
        announce_view(view->server(), "until the demo ends");
      }
      return view;
    };
  }
  trial::require_own_processes(scenario);
  const DemoResult result =
      run_demo(scenario, trial::trial_recipes(scenario), options, stop_requested);
  if (!arguments.as_json) {
    print_line("");
  }
  report_summary(scenario, result.summary, arguments.as_json);
  if (!arguments.as_json) {
    print_line("log      " + result.log_path);
    const std::string png = result.png_path.empty() ? result.png_error : result.png_path;
    if (!result.svg_path.empty()) {
      print_line("picture  " + result.svg_path);
    }
    if (!png.empty()) {
      print_line("         " + png);
    }
    print_line("open     vantage view " + shell_quoted(result.log_path));
  }
  for (const std::string& failure : result.failures) {
    print_line("vantage: " + failure, stderr);
  }
  return result.summary.collisions == 0 && result.failures.empty() ? 0 : 1;
}

}  // namespace

void add_demo_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "demo", "Run a simulated trial in real time in one process; needs no network.");
  auto arguments = std::make_shared<DemoArguments>();
  command->add_option("--scenario", arguments->scenario,
                      "scenario file, or a name from `vantage config list` (default: lab)");
  command->add_option("--out", arguments->directory, "folder for the log and the pictures")
      ->capture_default_str();
  add_override_options(*command, arguments->overrides);
  command->add_flag("--json", arguments->as_json,
                    "print one JSON object at the end instead of tables");
  command->add_flag("--view", arguments->is_shown,
                    "serve a live view of the trial for the browser");
  add_web_options(*command, arguments->web);
  command->footer(
      "Runs for 60 s unless --duration-s is given. Ctrl-C, SIGTERM or closing the terminal ends "
      "it\n"
      "early with the same summary. Exit code 1 after a collision, a failure or an output that\n"
      "cannot be written.\n"
      "Examples:\n"
      "  vantage demo\n"
      "  vantage demo --view\n"
      "  vantage demo --duration-s 300 --planner lawn_mower --out lawn");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
