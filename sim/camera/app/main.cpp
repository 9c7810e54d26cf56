// vantage-camera-emulator: renders the images of one robot's simulated camera from TRUTH, and
// writes them to the folder that vantage-camera reads.

#include "bus/node/node_main.hpp"
#include "sim/camera/app/node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
  return bus::node_main(
      {"vantage-camera-emulator", "Renders the images of one robot's simulated camera.", true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) {
        return sim::start_camera_emulator(bus, clock, scenario, arguments.robot);
      });
}
