#include "tools/console/console.hpp"

#include <memory>

#include "core/process.hpp"
#include "tools/commands/commands.hpp"
#include "tools/console/operator_link.hpp"

namespace vantage::tools {
namespace {

struct ConsoleArguments {
  std::string url;
  std::string scenario;
  bool is_second = false;
};

int run(const ConsoleArguments& arguments) {
  OperatorLink link(arguments.url, arguments.scenario);
  const StationOptions options{arguments.is_second, link.authenticator()};
  return run_console(link.bus(), link.clock(), options, stop_requested) ? 0 : 1;
}

}  // namespace

void add_console_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "console", "Operator's console: heartbeat, arm, take off, follow, hold, land, e-stop.");
  auto arguments = std::make_shared<ConsoleArguments>();
  command->add_option("--url", arguments->url,
                      "LCM URL (default: the scenario's, without --scenario $LCM_DEFAULT_URL)");
  command->add_option("--scenario", arguments->scenario,
                      "scenario file; its security keys sign the commands of this station");
  command->add_flag(
      "--second", arguments->is_second,
      "run as standby next to a station that is in charge: can hold, land and e-stop, "
      "and takes over when the other station stops sending");
  command->footer(
      "Keys: SPACE emergency stop of all vehicles, even if one robot is selected.\n"
      "      For the selected robots: a arm, t take off, f follow, h hold, l land,\n"
      "      e emergency stop.\n"
      "      Selection: 0 all, 1-9 one of the first nine robots, TAB the next, r NAME ENTER any.\n"
      "      q quit (stops the heartbeat).\n"
      "Without a terminal, commands are read as lines from standard input. If another station is\n"
      "in charge, only the emergency stop is sent. Exit code 1 if a command was refused, was not\n"
      "understood, or named a robot from which no message was received.\n"
      "Examples:\n"
      "  vantage console\n"
      "  vantage console --scenario config/lab-mixed.yaml\n"
      "  echo 'land Q1' | vantage console --url 'udpm://239.255.76.67:7667?ttl=0'");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
