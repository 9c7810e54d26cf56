#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// How to make one node of a trial on a bus of its own.
struct NodeRecipe {
  std::string name;  ///< unique in the trial; gives the node its run id in virtual time
  std::function<std::unique_ptr<bus::Node>(bus::Bus&, const bus::Clock&)> make;
};

/// Every node of a wholly simulated trial, in the order in which those due at the same instant
/// act: the simulator, then each robot's sensor, each estimator, each planner. `scenario` must
/// outlive the nodes. In virtual time the planners of one list share a workspace: one thread, one
/// trial at a time; on a real clock each has one of its own.
std::vector<NodeRecipe> trial_recipes(const scenario::Scenario& scenario);

/// A run id that depends on these two alone; never 0.
std::int64_t deterministic_run_id(std::uint64_t seed, const std::string& node_name);

}  // namespace vantage::trial
