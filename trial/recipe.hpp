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

/// Name and factory of one node of a trial, which runs on its own bus.
struct NodeRecipe {
  std::string name;  ///< unique in the trial; determines the run id in virtual time
  std::function<std::unique_ptr<bus::Node>(bus::Bus&, const bus::Clock&)> make;
  std::string host{};  ///< robot whose computer runs the node; empty: a computer of the lab
};

/// Returns the recipes of all nodes of a fully simulated trial: the simulator, then the localizers,
/// sensors, estimators and planners of all robots, without those that are external. Nodes that are
/// due at the same instant are executed in this order. `scenario` must outlive the nodes. In
/// virtual time the planners of one list share a workspace, so one list is for one thread and one
/// trial at a time. With a real clock each planner has its own workspace.
std::vector<NodeRecipe> trial_recipes(const scenario::Scenario& scenario);

/// Returns a nonzero run id that depends only on the seed and the name.
std::int64_t deterministic_run_id(std::uint64_t seed, const std::string& node_name);

}  // namespace vantage::trial
