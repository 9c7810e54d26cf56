// vantage-rover: drives one rover. Subscribes to VICON, PLAN_*, COMMAND and SCENARIO, publishes
// VEHICLE_R; one process per robot.

#include <memory>

#include "bus/node/node_main.hpp"
#include "core/check.hpp"
#include "drivers/rover/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-rover", "Drives one rover with the protocol that docs/guide/rovers.md defines.",
       true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        const auto& rover = scenario.find_robot(arguments.robot)->rover;
        if (!rover) {
          throw StartupError("robot " + arguments.robot + " has no `rover` in " +
                             arguments.scenario);
        }
        return std::make_unique<drivers::RoverNode>(bus, clock, scenario, arguments.robot,
                                                    drivers::open_port(rover->url));
      });
}
