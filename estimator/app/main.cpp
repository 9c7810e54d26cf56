// vantage-estimator: what one robot knows of the targets. MEASUREMENT_R, VICON and the teammates'
// BELIEF_* in, BELIEF_R out.

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/transport.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "estimator/app/node.hpp"
#include "estimator/app/replay_node.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Estimates the targets for one robot: MEASUREMENT_R, VICON, BELIEF_* -> BELIEF_R"};
  std::string scenario_path;
  std::string robot;
  std::string url;
  std::string prefix;
  bool replay = false;
  app.add_option("--scenario", scenario_path, "scenario file (YAML)")->required();
  app.add_option("--robot", robot, "name of the robot in the scenario")->required();
  app.add_option("--url", url, "LCM URL; default: the scenario's");
  app.add_option("--publish-prefix", prefix, "put before the name of every channel published on");
  app.add_flag("--replay", replay, "do the logged steps again, from the inputs that they name");
  app.footer(
      "Examples:\n  vantage-estimator --scenario lab.yaml --robot Q1\n"
      "  vantage-estimator --scenario lab.yaml --robot Q1 --replay --publish-prefix REPLAY_");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return vantage::run_process("vantage-estimator", [&] {
    vantage::require(!replay || !prefix.empty(), "--replay needs a --publish-prefix");
    const auto scenario = vantage::bus::load_scenario(scenario_path);
    const auto transport = vantage::bus::open_transport(url.empty() ? scenario.network.url : url);
    vantage::bus::Bus bus(*transport, vantage::bus::random_run_id(), prefix);
    const vantage::bus::SystemClock clock;
    std::unique_ptr<vantage::bus::Node> node;
    if (replay) {
      node = std::make_unique<vantage::estimator::ReplayNode>(bus, clock, scenario, robot);
    } else {
      node = std::make_unique<vantage::estimator::EstimatorNode>(bus, clock, scenario, robot);
    }
    vantage::bus::run_node(bus, *node, clock, vantage::stop_requested);
    return 0;
  });
}
