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

/// Recipe for one node of a trial on its own bus.
struct NodeRecipe {
  std::string name;  ///< unique in the trial; determines the run id in virtual time
  std::function<std::unique_ptr<bus::Node>(bus::Bus&, const bus::Clock&)> make;
};

/// Returns the recipes of all nodes of a fully simulated trial, in the order in which nodes that
/// are due at the same instant are executed: the simulator, then the sensors, estimators and
/// planners of all robots. `scenario` must outlive the nodes. In virtual time the planners of one
/// list share a workspace: use one thread and one trial at a time. With a real clock each planner
/// has its own.
std::vector<NodeRecipe> trial_recipes(const scenario::Scenario& scenario);

/// Returns a run id that depends on the seed and the name alone; never 0.
std::int64_t deterministic_run_id(std::uint64_t seed, const std::string& node_name);

}  // namespace vantage::trial
