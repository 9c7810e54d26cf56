// vantage-estimator: estimator process of one robot. Inputs: MEASUREMENT_R, VICON and the
// teammates' BELIEF_*. Outputs: MIXTURE_R and BELIEF_R.

#include <memory>

#include "bus/node/node_main.hpp"
#include "estimator/app/node.hpp"
#include "estimator/app/replay_node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): only in this main file
  return bus::node_main(
      {"vantage-estimator", "Estimates the targets with the information available to one robot.",
       true, true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        if (arguments.replay) {
          return std::make_unique<estimator::EstimatorReplayNode>(bus, clock, scenario,
                                                                  arguments.robot);
        }
        return std::make_unique<estimator::EstimatorNode>(bus, clock, scenario, arguments.robot);
      });
}
