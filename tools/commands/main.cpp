#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <poll.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "trial/observe/announcer.hpp"

int main(int argc, char** argv) {
  return vantage::run_process("vantage", [&]() -> int {
    CLI::App app{"Plan, fly and evaluate trials of robot teams that gather information.",
                 "vantage"};
    app.footer("vantage COMMAND --help describes a command.");
    app.set_version_flag("--version", vantage::trial::version());
    vantage::tools::Runner run;
    vantage::tools::add_demo_command(app, run);
    vantage::tools::add_trial_command(app, run);
    vantage::tools::add_up_command(app, run);
    vantage::tools::add_check_command(app, run);
    vantage::tools::add_config_command(app, run);
    vantage::tools::add_plan_command(app, run);
    vantage::tools::add_console_command(app, run);
    vantage::tools::add_doctor_command(app, run);
    vantage::tools::add_experiment_command(app, run);
    vantage::tools::add_view_command(app, run);
    vantage::tools::add_ros2_command(app, run);
    vantage::tools::add_log_command(app, run);
    vantage::tools::add_keys_command(app, run);
    vantage::tools::add_python_command(app, run);
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!words.empty() && words.front() == "help") {  // "help trial" means "trial --help"
      words.erase(words.begin());
      words.emplace_back("--help");
    }
    try {
      if (const std::string unknown = vantage::tools::unknown_command(app, words);
          !unknown.empty()) {
        throw vantage::StartupError(unknown);
      }
      app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::ExtrasError& error) {
      const std::string unknown = vantage::tools::unknown_option(app, words);
      throw vantage::StartupError(unknown.empty() ? error.what() : unknown);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    if (!run) {
      vantage::tools::print_line(app.help(), stderr);
      return 2;
    }
    const int code = run();
    // Output that could not be written is a failure. No message is printed if the reader, such as
    // head, has closed the pipe.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      pollfd out{STDOUT_FILENO, POLLOUT, 0};
      if (poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0) {
        return std::max(code, 1);
      }
      std::fputs("vantage: cannot write to standard output\n", stderr);
      return std::max(code, 1);
    }
    return code;
  });
}
