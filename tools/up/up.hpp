#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "logs/metrics/trial_summary.hpp"
#include "scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"
#include "tools/up/log_keeper.hpp"

namespace vantage::tools {

struct UpOptions {
  std::string executables;                   ///< folder of the vantage-* programs
  std::string log_path;                      ///< path of the log; empty: no log
  int log_sync_ms = 40;                      ///< ms, > 0; pause between two syncs of the log
  std::string host;                          ///< host of scenario.hosts to run; empty: everything
  std::string firmware_folder = "firmware";  ///< folder with the firmware's working folders
  bool quiet = false;
  bool live_table = false;       ///< redraw a table in place; else print a line every 5 s
  bool fly = false;              ///< arm, take off and follow at the start, land at the end
  bool ends_by_duration = true;  ///< end the trial after scenario.duration_s
  bool ignore_others = false;    ///< start although processes of another trial are alive
  bool ignore_load = false;      ///< fly although the host is busy and grants no priority
  /// priority of the drivers (ProcessSettings); set by run_up() if the system grants it
  int driver_priority = 0;
  bool has_virtual_targets = false;  ///< simulate the targets although every device is real
  RestartPolicy restarts;
  /// Returns the number of requests to end so far. The second request ends the wait for landings:
  /// the autopilots land the vehicles still in flight. The third request, or the second if no
  /// vehicle has to land, kills the processes that have not ended yet.
  std::function<int()> stop_requests = [] { return 0; };
};

struct UpResult {
  logs::TrialSummary summary;
  std::vector<SupervisedStatus> processes;  ///< state at the end of the trial; the recorder is last
  LogOutcome log;
  bool log_was_unwritten = false;        ///< the log could not be written for some time
  int world_restarts = 0;                ///< restarts of the simulator, which reset the world
  bool has_other_scenario = false;       ///< another host flies another scenario file
  std::string broken;                    ///< error of this program; empty: none
  double stop_s = 0.0;                   ///< s; from the last landing to the end of all processes
  std::vector<std::string> killed;       ///< processes that did not end in time
  std::vector<std::string> cut_short;    ///< processes killed because of a further request to end
  std::vector<std::string> ended_badly;  ///< processes that failed while ending: "sim (signal 6)"
  std::vector<std::string> never_flown;  ///< with `fly`: vehicles that have never followed a plan
  std::vector<std::string> left_flying;  ///< vehicles that were in flight at the end
  std::int64_t contacts_unverified = 0;  ///< COLLISION messages refused because of their signature
};

/// Flies a scenario with one process per node of this host, over scenario.network.url. Restarts
/// processes that die. Ends after scenario.duration_s (if ends_by_duration), when `stop` returns
/// true, or when an essential process is given up.
///
/// At the end the vehicle drivers are ended first; they land or stop their vehicles. All other
/// processes keep running during this time, for at most 60 s. Collisions, separation violations and
/// lost messages during the landings are counted; the rest of the summary covers the trial only.
/// The log begins with SCENARIO and ends with the last published message.
///
/// Publishes the states of the processes on HOST_<host> and receives the reports of other hosts,
/// which may start and end at any time.
///
/// With `fly`, acts as the operator of the vehicles that have drivers. Its commands and heartbeats
/// are in the log. Any other station may still hold, land or stop a vehicle.
///
/// Listens to the network for kListenTime first (unless ignore_others). Drivers get SCHED_FIFO if
/// the system grants it. If the system does not grant it and the host is busy, `fly` is refused
/// unless ignore_load is set; without `fly` a warning is printed.
/// @throws StartupError
/// - if other processes are alive (conflicts_with_up) and ignore_others is not set;
/// - if the disk has too little space for the log;
/// - if the network, the recorder or a program cannot be used;
/// - if the combination of devices or the security of the scenario has a fault;
/// - if `fly` is set for a real robot, which only a person may arm.
UpResult run_up(const scenario::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
