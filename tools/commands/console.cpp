#include "tools/console/console.hpp"

#include <memory>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "core/process.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "tools/commands/commands.hpp"

namespace vantage::tools {
namespace {

struct ConsoleArguments {
  std::string url;
  std::string scenario;
  bool is_second = false;
};

int run(const ConsoleArguments& arguments) {
  const bus::SteadyClock clock;
  std::unique_ptr<bus::auth::Authenticator> authenticator;
  std::string url = arguments.url;
  if (!arguments.scenario.empty()) {
    const scenario::Scenario scenario = scenario::load_scenario(arguments.scenario);
    bus::auth::require_operator(scenario);
    authenticator = bus::auth::authenticator_for(scenario);
    url = url.empty() ? scenario.network.url : url;
  }
  const auto transport = bus::open_transport(url);
  bus::Bus bus(*transport, bus::random_run_id());
  const StationOptions options{arguments.is_second, authenticator.get()};
  bus.use_clock(clock);
  bus.secure(std::move(authenticator), clock);
  return run_console(bus, clock, options, stop_requested) ? 0 : 1;
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
      "Keys: SPACE emergency stop of all vehicles, also if one robot is selected.\n"
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
