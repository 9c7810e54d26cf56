// vantage-sim: the simulated lab. PLAN_* and COMMAND in; VICON, TRUTH, COLLISION, QUADROTOR_R out.

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/node.hpp"
#include "bus/scenario_yaml.hpp"
#include "bus/transport.hpp"
#include "core/process.hpp"
#include "sim/app/node.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Simulates the lab: PLAN_*, COMMAND -> VICON, TRUTH, COLLISION, QUADROTOR_R"};
  std::string scenario_path;
  std::string url;
  std::optional<std::uint64_t> seed;
  app.add_option("--scenario", scenario_path, "scenario file (YAML)")->required();
  app.add_option("--seed", seed, "instead of the scenario's");
  app.add_option("--url", url, "LCM URL; default: the scenario's");
  app.footer("Example:\n  vantage-sim --scenario lab.yaml --seed 7");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return vantage::run_process("vantage-sim", [&] {
    auto scenario = vantage::bus::load_scenario(scenario_path);
    scenario.seed = seed.value_or(scenario.seed);
    const auto transport = vantage::bus::open_transport(url.empty() ? scenario.network.url : url);
    vantage::bus::Bus bus(*transport, vantage::bus::random_run_id());
    const vantage::bus::SystemClock clock;
    vantage::sim::SimNode node(bus, clock, scenario);
    vantage::bus::run_node(bus, node, clock, vantage::stop_requested);
    return 0;
  });
}
