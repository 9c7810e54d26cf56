#pragma once

#include <string>
#include <vector>

#include "models/scenario/scenario.hpp"

namespace vantage::tools {

/// What a look at a scenario before flying found.
struct Preflight {
  std::vector<std::string> understood;  ///< the trial in a few lines
  std::vector<std::string> faults;      ///< why it must not fly
  [[nodiscard]] bool is_ready() const { return faults.empty(); }
};

/// Checks what a reader of the file alone cannot: every robot's start is clear of obstacles and
/// walls by its radius and the planner's margin, can be stopped at, no two starts are nearer than
/// the separation, stated targets start on free ground, the slots fit into the round; and flight
/// safety has limits that it can keep and refuses none of the robots' primitives.
Preflight check_preflight(const models::Scenario& scenario);

}  // namespace vantage::tools
