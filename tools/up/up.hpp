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
  std::string executables;  ///< the folder of the vantage-* programs
  std::string log_path;     ///< empty: no log
  std::string host;         ///< the one of scenario.hosts to run; empty: everything there is
  std::string firmware_folder = "firmware";  ///< where firmware works and leaves what it writes
  bool quiet = false;
  bool live_table = false;           ///< redraw a table in place; else a line each 5 s
  bool fly = false;                  ///< arm, take off and follow at the start, land at the end
  bool ends_by_duration = true;      ///< the trial, after scenario.duration_s
  bool beside_others = false;        ///< start though others of another trial are alive
  bool beside_load = false;          ///< fly though the host is busy and grants no priority
  int driver_priority = 0;           ///< see ProcessPlaces; run_up() sets it where it is granted
  bool has_virtual_targets = false;  ///< simulate the targets though every device is real
  RestartPolicy restarts;
  /// The number of requests to end so far. The second one does not wait for landings: it leaves
  /// what still flies to the autopilots' own landing. The next one, or the second where there is
  /// nothing to land, kills the processes that have not ended yet.
  std::function<int()> stop_requests = [] { return 0; };
};

struct UpResult {
  logs::TrialSummary summary;
  std::vector<SupervisedStatus> processes;  ///< at the end; the logger's is the last
  LogOutcome log;
  bool log_was_unwritten = false;        ///< for a while; the flight went on
  int world_restarts = 0;                ///< of the simulator: the world began anew
  bool has_other_scenario = false;       ///< another host flies another scenario file
  std::string broken;                    ///< what went wrong in the program itself, if anything
  double stop_s = 0.0;                   ///< from the end (of the landings) until all were gone
  std::vector<std::string> killed;       ///< that did not end in time by themselves
  std::vector<std::string> cut_short;    ///< killed because one more request left them no time
  std::vector<std::string> ended_badly;  ///< asked to end, crashed or failed: "sim (signal 6)"
  std::vector<std::string> never_flown;  ///< vehicles to be flown that followed no plan
  std::vector<std::string> left_flying;  ///< vehicles that were in flight at the end
  std::int64_t contacts_unverified = 0;  ///< COLLISION messages refused by their signatures
};

/// Flies a scenario with one process for each node of this host, over scenario.network.url, until
/// scenario.duration_s is over (if ends_by_duration), `stop`, or an essential process is given up;
/// starts again what dies. At the end, whatever its reason, the drivers of vehicles are ended
/// first, which land or stop their vehicles, while everything else goes on; that takes 60 s at
/// most. The log begins with SCENARIO and ends with what was published last. What runs is published
/// on HOST_<host>, other hosts are heard there, and either may come and go.
///
/// With `fly` it is the operator of the vehicles that have drivers: its commands and its heartbeat
/// are in the log, any other station may still hold, land or stop a vehicle. What happens during
/// the landings counts as a contact, not as part of the trial.
/// Listens for kListenToNeighbours first.
/// Drivers get SCHED_FIFO where the system grants it. Where it does not and the host is busy, `fly`
/// is refused unless it is to be beside load; without `fly` that is a warning.
/// @throws StartupError when others are alive (rivals_of_up) and it is not to be beside them; when
/// there is no room for the log, the network, the logger or a program cannot be used, the devices
/// do
///         not fit together, or `fly` is asked for a real robot: these are armed by a person.
UpResult run_up(const scenario::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
