// vantage-camera: detects the tags in the images of one robot's camera. Subscribes to VICON and
// ATTACK, publishes MEASUREMENT_R; one process per robot with `sensor.device: camera`.

#include <memory>

#include "bus/node/node_main.hpp"
#include "drivers/camera/app/start.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): main file only
  return bus::node_main(
      {"vantage-camera", "Measures targets by the tags in camera images.", true}, argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) {
        return drivers::start_camera(bus, clock, scenario, arguments.robot);
      });
}
