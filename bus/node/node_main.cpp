#include "bus/node/node_main.hpp"

#include <cstdint>
#include <iostream>
#include <set>

#include <CLI/CLI.hpp>

#include "bus/auth/authenticator.hpp"
#include "bus/node/air_budget.hpp"
#include "bus/node/flights.hpp"
#include "bus/node/process_usage.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "core/liveness.hpp"
#include "core/process.hpp"
#include "core/real_time.hpp"
#include "scenario/reader/overrides.hpp"

namespace vantage::bus {

namespace {

std::set<std::string> robots_with_driver(const scenario::Scenario& scenario) {
  std::set<std::string> out;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.device != scenario::DeviceSource::kDirect) {
      out.insert(robot.name);
    }
  }
  return out;
}

/// Counter of the stop requests that the process obeys. A process that serves vehicles delays the
/// first request until the vehicles have landed.
class StopRequests {
 public:
  StopRequests(Bus& bus, const Clock& clock, const scenario::Scenario& scenario, bool serves)
      : clock_(clock), flights_(robots_with_driver(scenario)) {
    if (serves && !robots_with_driver(scenario).empty()) {
      bus.subscribe<models::VehicleStatus>(vehicle_channel("*"),
                                           [this](const models::VehicleStatus& status) {
                                             flights_.on_status(status, clock_.now());
                                           });
    }
  }
  [[nodiscard]] int count() {
    const Time now = clock_.now();
    return end_.requests(stop_requests(), !flights_.in_flight(now).empty(), now);
  }

 private:
  const Clock& clock_;
  Flights flights_;
  EndAfterFlights end_;
};

}  // namespace

// Long function: it contains the start, loop and end of a process, in order.
int node_main(const NodeProgram& program, int argc, char** argv, const MakeNode& make_node) {
  return run_process(program.name, [&]() -> int {
    LivenessSender life;
    const RealTime real_time = take_real_time(argc, argv);
    CLI::App app{program.description, program.name};
    app.footer(
        "Real time:\n"
        "  --fifo PRIORITY             SCHED_FIFO with this priority, 1 to 99\n"
        "  --cpu N                     run on this CPU only\n"
        "  --lock-memory               keep all memory in RAM, without page faults\n"
        "If the system denies an option, the program ends and names the limit to raise.");
    NodeArguments arguments;
    scenario::Overrides overrides;
    app.add_option("--scenario", arguments.scenario, "scenario file")->required();
    auto* robot = app.add_option("--robot", arguments.robot, "name of a robot in the scenario");
    if (program.needs_robot) {
      robot->required();
    }
    app.add_option("--url", arguments.url, "LCM URL instead of the scenario's");
    app.add_option("--seed", overrides.seed, "seed instead of the scenario's");
    app.add_option("--planner", overrides.planner, "planning algorithm instead of the scenario's");
    app.add_option("--publish-prefix", arguments.publish_prefix,
                   "prefix of every channel that this process publishes");
    if (program.can_replay) {
      app.add_flag("--replay", arguments.replay,
                   "recompute the outputs of a log that is being replayed, from the inputs that "
                   "the log lists for each output");
    }
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }

    const scenario::Scenario scenario = scenario::load_scenario_with(arguments.scenario, overrides);
    if (program.needs_robot && scenario.find_robot(arguments.robot) == nullptr) {
      throw StartupError("no robot '" + arguments.robot + "' in " + arguments.scenario);
    }
    // Drivers and the processes that serve vehicles must also run without a network.
    const auto transport = open_waiting_transport(
        arguments.url.empty() ? scenario.network.url : arguments.url,
        [&](const std::string& words) { std::cerr << program.name << ": " << words << '\n'; });
    Bus bus(*transport, random_run_id(), arguments.publish_prefix);
    const SteadyClock clock;
    if (arguments.replay) {
      bus.secure(auth::replay_authenticator_for(scenario), clock);
    } else {
      bus.secure(auth::authenticator_for(scenario), clock);
      bus.use_clock(clock);
      if (scenario.network.budget_kbitps > 0.0) {
        bus.limit_air(std::make_unique<AirBudget>(scenario), clock);
      }
    }
    apply(real_time);  // after the transport's threads start, before the node allocates
    const std::unique_ptr<Node> node = make_node(bus, clock, scenario, arguments);
    StopRequests requests(bus, clock, scenario, program.serves_vehicles);
    const ThreadWait wait;
    run_node(
        bus, *node, clock, [&] { return requests.count(); }, usage_counters, &life,
        [&wait] { return wait.waited_us(); });
    const std::string fault = node->end_fault();
    if (!fault.empty()) {
      std::cerr << program.name << ": " << fault << '\n';
    }
    return fault.empty() ? 0 : 1;
  });
}

}  // namespace vantage::bus
