#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_usage.hpp"
#include "bus/transport/transport.hpp"
#include "core/liveness.hpp"
#include "core/process.hpp"
#include "scenario/reader/scenario_ros2_yaml.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "tools/ros2/bridge_node.hpp"
#include "tools/ros2/port.hpp"

namespace vantage::tools {
namespace {

struct Ros2Arguments {
  std::string scenario;
  std::string url;
};

/// Returns the first line of output, which states the programs that can connect.
std::string first_line(const scenario::Ros2Spec& spec) {
  return fmt::format("ros2     domain {} on network card {}{}", spec.domain, spec.interface,
                     spec.interface == "lo" ? ": only programs on this host that also use only lo "
                                              "can connect (ROS_LOCALHOST_ONLY=1)"
                                            : "");
}

int run(const Ros2Arguments& arguments) {
  LivenessSender life;
  const scenario::Scenario scenario = scenario::load_scenario(arguments.scenario);
  const scenario::Ros2Spec spec = scenario::ros2_of(scenario).value_or(scenario::Ros2Spec{});
  const bus::SteadyClock clock;
  const auto transport = bus::open_waiting_transport(
      arguments.url.empty() ? scenario.network.url : arguments.url,
      [](const std::string& words) { std::cerr << "vantage ros2: " << words << '\n'; });
  bus::Bus bus(*transport, bus::random_run_id());
  bus.use_clock(clock);
  bus.secure(bus::auth::authenticator_for(scenario), clock);
  print_line(first_line(spec));
  const std::unique_ptr<ros2::Port> port = ros2::open_port(spec);
  ros2::BridgeNode node(bus, clock, *port, scenario, spec);
  bus::run_node(
      bus, node, clock, [] { return stop_requests(); }, bus::usage_counters, &life);
  return 0;
}

}  // namespace

void add_ros2_command(CLI::App& root, Runner& chosen) {
  CLI::App* command =
      root.add_subcommand("ros2", "Connect the running system to ROS 2; ROS itself is not needed.");
  auto arguments = std::make_shared<Ros2Arguments>();
  add_scenario_option(*command, arguments->scenario);
  command->add_option("--url", arguments->url, "LCM URL instead of the scenario's");
  command->footer(
      "Publishes poses, plans, beliefs, maps, scans, batteries and health on ROS 2 topics. Reads\n"
      "poses in place of motion capture and detections, from the topics that the section `ros2` "
      "of\n"
      "the scenario lists. The section also sets the domain (default: 0) and the network card\n"
      "(default: lo, this host only). Ends with Ctrl-C.\n"
      "Examples:\n"
      "  vantage ros2 lab\n"
      "  vantage ros2 config/lab.yaml --url 'udpm://239.255.76.67:7667?ttl=1'");
  run_on_scenario(*command, chosen, arguments, run);
}

}  // namespace vantage::tools
