// vantage-sensor: computes the measurements of one robot from mocap poses. Subscribes to VICON and
// ATTACK, publishes MEASUREMENT_R (and SCAN_R if the team maps); one process per robot.

#include <memory>

#include "bus/node/node_main.hpp"
#include "drivers/sensor/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-sensor", "Measures targets for one robot from mocap poses.", true}, argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        return std::make_unique<drivers::SensorNode>(bus, clock, scenario, arguments.robot);
      });
}
