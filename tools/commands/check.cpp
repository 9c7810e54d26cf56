#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/scenario_yaml.hpp"
#include "tools/check/preflight.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct CheckArguments {
  std::string scenario;
  bool as_json = false;
};

int run(const CheckArguments& arguments) {
  const Preflight preflight = check_preflight(bus::load_scenario(arguments.scenario));
  if (arguments.as_json) {
    print_line(nlohmann::ordered_json{{"scenario", arguments.scenario},
                                      {"ready", preflight.is_ready()},
                                      {"understood", preflight.understood},
                                      {"faults", preflight.faults}}
                   .dump());
  } else {
    for (const std::string& line : preflight.understood) {
      print_line(line);
    }
    for (const std::string& fault : preflight.faults) {
      fmt::print(stderr, "{}: {}\n", arguments.scenario, fault);
    }
    print_line(preflight.is_ready() ? "ready" : "not ready");
  }
  return preflight.is_ready() ? 0 : 1;
}

}  // namespace

void add_check_command(CLI::App& root, Runner& chosen) {
  CLI::App* command =
      root.add_subcommand("check", "Read a scenario and say whether it can be flown.");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("scenario", arguments->scenario, "scenario file")->required();
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Exit code 0: ready; 1: it says what it says, but must not fly; 2: it cannot be read.\n"
      "Example:\n"
      "  vantage check config/lab.yaml");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
