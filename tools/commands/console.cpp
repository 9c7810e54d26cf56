#include "tools/console/console.hpp"

#include <memory>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/transport.hpp"
#include "core/process.hpp"
#include "tools/commands/commands.hpp"

namespace vantage::tools {
namespace {

int run(const std::string& url) {
  const auto transport = bus::open_transport(url);
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SystemClock clock;
  run_console(bus, clock, stop_requested);
  return 0;
}

}  // namespace

void add_console_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand(
      "console", "Operator's console: heartbeat, arm, take off, follow, hold, land, e-stop.");
  auto url = std::make_shared<std::string>();
  command->add_option("--url", *url, "LCM URL; $LCM_DEFAULT_URL when not given");
  command->footer(
      "Keys: a arm, t take off, f follow, h hold, l land, SPACE or e emergency stop,\n"
      "      1-9 select a robot, 0 all, q quit (ends the heartbeat).\n"
      "Without a terminal it reads lines.\n"
      "Examples:\n"
      "  vantage console\n"
      "  echo 'land Q1' | vantage console --url 'udpm://239.255.76.67:7667?ttl=0'");
  command->callback([&chosen, url] { chosen = [url] { return run(*url); }; });
}

}  // namespace vantage::tools
