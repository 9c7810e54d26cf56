// vantage-localizer: pose of one robot from odometry, landmarks, teammates and motion capture.
// Inputs: ODOMETRY_R, SIGHTINGS_R, the teammates' POSE_* and VICON. Output: POSE_R.

#include <memory>

#include "bus/node/node_main.hpp"
#include "localizer/app/node.hpp"
#include "localizer/app/replay_node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
  return bus::node_main(
      {"vantage-localizer", "Estimates one robot's pose from odometry, landmarks and teammates.",
       true, true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        if (arguments.replay) {
          return std::make_unique<localizer::LocalizerReplayNode>(bus, clock, scenario,
                                                                  arguments.robot);
        }
        return std::make_unique<localizer::LocalizerNode>(bus, clock, scenario, arguments.robot);
      });
}
