// vantage-natnet: receives the frames of OptiTrack Motive and publishes VICON. The scenario's
// `mocap` gives the address of the server.

#include <cstdio>
#include <memory>
#include <string>

#include "bus/node/node_main.hpp"
#include "core/utf8.hpp"
#include "drivers/natnet/natnet_session.hpp"
#include "drivers/vicon/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {.name = "vantage-natnet",
       .description = "Publishes the poses that OptiTrack Motive measures.",
       .serves_vehicles = true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& /*arguments*/) -> std::unique_ptr<bus::Node> {
        return std::make_unique<drivers::ViconNode>(
            bus, clock, scenario, drivers::natnet::natnet_row(), [](const std::string& status) {
              std::fprintf(stderr, "vantage-natnet: %s\n", printable(status).c_str());
            });
      });
}
