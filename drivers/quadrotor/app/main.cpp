// vantage-quadrotor: controls one quadrotor with a MAVLink autopilot. Subscribes to VICON, PLAN_*,
// COMMAND and SCENARIO, publishes VEHICLE_R; one process per robot.

#include <memory>

#include "bus/node/node_main.hpp"
#include "core/check.hpp"
#include "drivers/quadrotor/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-quadrotor", "Flies one quadrotor with a MAVLink autopilot.", true}, argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        const auto& autopilot = scenario.find_robot(arguments.robot)->autopilot;
        if (!autopilot) {
          throw StartupError("robot " + arguments.robot + " has no `autopilot` in " +
                             arguments.scenario);
        }
        return std::make_unique<drivers::QuadrotorNode>(bus, clock, scenario, arguments.robot,
                                                        drivers::open_port(autopilot->url));
      });
}
