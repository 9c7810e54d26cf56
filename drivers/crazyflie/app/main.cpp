// vantage-crazyflie: controls one Crazyflie. Subscribes to VICON, PLAN_*, COMMAND and SCENARIO,
// publishes VEHICLE_R; one process per robot.

#include <memory>

#include "bus/node/node_main.hpp"
#include "core/check.hpp"
#include "drivers/crazyflie/app/node.hpp"
#include "drivers/crazyflie/app/table_files.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-crazyflie", "Flies one Crazyflie.", true}, argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        const auto& spec = scenario.find_robot(arguments.robot)->crazyflie;
        if (!spec) {
          throw StartupError("robot " + arguments.robot + " has no `crazyflie` in " +
                             arguments.scenario);
        }
        return std::make_unique<drivers::CrazyflieNode>(
            bus, clock, scenario, arguments.robot, drivers::open_crazyflie_port(spec->url),
            std::make_shared<drivers::TableFiles>(drivers::TableFiles::default_folder()));
      });
}
