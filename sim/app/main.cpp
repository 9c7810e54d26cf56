// vantage-sim: the simulated lab. Publishes TRUTH and COLLISION. For direct devices it receives
// PLAN_* and COMMAND and publishes VICON and VEHICLE_R; for `wire` devices it runs a mocap server
// and emulated autopilots and rovers.

#include <memory>

#include "bus/node/node_main.hpp"
#include "sim/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
  return bus::node_main(
      {.name = "vantage-sim",
       .description =
           "Simulates the lab: quadrotors that follow plans, rovers, motion capture and contacts.",
       .serves_vehicles = true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& /*arguments*/) -> std::unique_ptr<bus::Node> {
        return std::make_unique<sim::SimNode>(bus, clock, scenario);
      });
}
