#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "scenario/scenario.hpp"

namespace vantage::bus {

/// Properties of a node executable that node_main() needs.
struct NodeProgram {
  std::string name;         ///< name of the executable
  std::string description;  ///< one sentence for --help
  bool needs_robot = false;
  bool can_replay = false;
  bool serves_vehicles = false;  ///< vehicles need the node until they land; see EndAfterFlights
};

struct NodeArguments {
  std::string scenario;
  std::string robot;
  std::string url;  ///< empty: URL of the scenario
  std::string publish_prefix;
  bool replay = false;
};

using MakeNode = std::function<std::unique_ptr<Node>(
    Bus& bus, const Clock& clock, const scenario::Scenario& scenario, const NodeArguments&)>;

/// Implements main() of a node. Parses --scenario, --robot, --url, --seed, --planner,
/// --publish-prefix, --replay and the real-time options of core/real_time. Loads the scenario,
/// opens the transport and runs the node on SteadyClock until a signal stops it. Returns the exit
/// code: 0, 1 (failed while running or at its end) or 2 (could not start).
int node_main(const NodeProgram& program, int argc, char** argv, const MakeNode& make_node);

}  // namespace vantage::bus
