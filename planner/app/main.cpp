// vantage-planner, one process per robot. Inputs: BELIEF_R, MIXTURE_R (or MAP_R), VICON, PLAN_*,
// ATTACK. Output: PLAN_R.

#include <memory>

#include "bus/node/node_main.hpp"
#include "planner/app/node.hpp"
#include "planner/app/replay_node.hpp"

int main(int argc, char** argv) {
  using namespace vantage;  // NOLINT(google-build-using-namespace): only main()
  return bus::node_main(
      {"vantage-planner", "Plans the motion of one robot in each planning round.", true, true},
      argc, argv,
      [](bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
         const bus::NodeArguments& arguments) -> std::unique_ptr<bus::Node> {
        if (arguments.replay) {
          return std::make_unique<planner::PlannerReplayNode>(bus, clock, scenario,
                                                              arguments.robot);
        }
        return std::make_unique<planner::PlannerNode>(bus, clock, scenario, arguments.robot);
      });
}
