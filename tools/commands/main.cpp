#include <CLI/CLI.hpp>

#include "core/process.hpp"
#include "tools/commands/commands.hpp"
#include "tools/observe/announcer.hpp"

int main(int argc, char** argv) {
  return vantage::run_process("vantage", [&]() -> int {
    CLI::App app{"Teams of robots that plan where to look.", "vantage"};
    app.require_subcommand(1);
    app.set_version_flag("--version", vantage::tools::version());
    vantage::tools::Runner run;
    vantage::tools::add_demo_command(app, run);
    vantage::tools::add_trial_command(app, run);
    vantage::tools::add_up_command(app, run);
    vantage::tools::add_check_command(app, run);
    vantage::tools::add_plan_command(app, run);
    vantage::tools::add_console_command(app, run);
    vantage::tools::add_doctor_command(app, run);
    vantage::tools::add_experiment_command(app, run);
    vantage::tools::add_view_command(app, run);
    vantage::tools::add_log_command(app, run);
    vantage::tools::add_keys_command(app, run);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    return run();
  });
}
