// vantage-sim: the simulated lab. TRUTH and COLLISION out; of direct devices PLAN_* and COMMAND in,
// VICON and VEHICLE_R out; of devices on the wire a mocap server and MAVLink autopilots.

#include <memory>

#include "bus/node/node_main.hpp"
#include "sim/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main alone
  return bus::node_main(
      {.name = "vantage-sim",
       .description = "Simulates the lab: quadrotors that follow plans, rovers, mocap, contacts.",
       .serves_vehicles = true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& /*arguments*/) -> std::unique_ptr<bus::Node> {
        return std::make_unique<sim::SimNode>(bus, clock, scenario);
      });
}
