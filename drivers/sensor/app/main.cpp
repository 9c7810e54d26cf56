// vantage-sensor: measurements of one robot, made from mocap poses. VICON, ATTACK in;
// MEASUREMENT_R out.

#include <string>

#include <CLI/CLI.hpp>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/transport.hpp"
#include "core/process.hpp"
#include "drivers/sensor/app/node.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Measures targets for one robot from mocap poses: VICON, ATTACK -> MEASUREMENT_R"};
  std::string scenario_path;
  std::string robot;
  std::string url;
  app.add_option("--scenario", scenario_path, "scenario file (YAML)")->required();
  app.add_option("--robot", robot, "name of the robot in the scenario")->required();
  app.add_option("--url", url, "LCM URL; default: the scenario's");
  app.footer("Example:\n  vantage-sensor --scenario lab.yaml --robot Q1");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return vantage::run_process("vantage-sensor", [&] {
    const auto scenario = vantage::bus::load_scenario(scenario_path);
    const auto transport = vantage::bus::open_transport(url.empty() ? scenario.network.url : url);
    vantage::bus::Bus bus(*transport, vantage::bus::random_run_id());
    const vantage::bus::SystemClock clock;
    vantage::drivers::SensorNode node(bus, clock, scenario, robot);
    vantage::bus::run_node(bus, node, clock, vantage::stop_requested);
    return 0;
  });
}
