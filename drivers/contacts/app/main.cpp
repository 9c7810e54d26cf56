// vantage-contacts: publishes contacts and near misses of the bodies that mocap tracks. Subscribes
// to VICON, VEHICLE_* and TRUTH, publishes COLLISION; one process for a trial with real vehicles.

#include <memory>

#include "bus/node/node_main.hpp"
#include "drivers/contacts/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-contacts", "Detects contacts and near misses of real bodies from motion capture."},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& /*arguments*/) -> std::unique_ptr<bus::Node> {
        return std::make_unique<drivers::ContactsNode>(bus, clock, scenario);
      });
}
