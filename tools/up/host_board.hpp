#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "tools/supervisor/supervisor.hpp"

namespace vantage::tools {

/// Host name in HOST_* if the scenario has no `hosts`: one host runs everything.
inline constexpr const char* kOnlyHost = "LOCAL";

/// Converts readings of used processor time into shares of a processor. Pure.
class UsageMeter {
 public:
  struct Reading {
    std::int64_t cpu_us = 0;
    std::int64_t memory_bytes = 0;
  };
  /// Writes the usage of the process `status.pid`, read at `now`, into `process`. Writes nothing if
  /// the process does not run (no reading). The share is a mean over at least 0.5 s; until then the
  /// last share is written.
  void fill(const SupervisedStatus& status, const std::optional<Reading>& reading, Time now,
            models::SupervisedProcess& process);

 private:
  struct Last {
    pid_t pid = 0;
    std::int64_t cpu_us = 0;
    Time at{};
    double share = 0.0;
  };
  std::map<std::string, Last> last_;
};

/// Status of the processes of all hosts of a trial, from the reports of their supervisors. Pure.
class HostBoard {
 public:
  static constexpr double kSilentAfter_s = 3.0;
  /// maximum number of hosts outside the scenario
  static constexpr std::size_t kOtherHostsMax = 32;
  static constexpr std::size_t kProcessesMax = 1024;  ///< processes stored per report

  /// @param own  name of this supervisor's host
  HostBoard(const scenario::Scenario& scenario, std::string own, std::int64_t own_run_id,
            Time start);

  /// Stores a report. Returns a sentence if the host is new, was restarted, reports again after
  /// silence, or uses the name of this host. Ignores reports of hosts beyond the limit.
  std::optional<std::string> on_report(const models::HostReport& report, Time now);
  /// Returns one sentence for each host that has become silent since the last call.
  std::vector<std::string> fallen_silent(Time now);
  /// Returns a heading, one line per process, and one line per host without a recent report.
  [[nodiscard]] std::vector<std::string> table(Time now) const;
  /// Returns the number of running and of all processes per host: "LAB 7/7, AIR silent for 4 s".
  /// Empty if there is one host and all its processes run.
  [[nodiscard]] std::string line(Time now) const;

 private:
  struct HostState {
    std::optional<models::HostReport> report;
    Time at{};
    bool is_silent = false;
  };
  std::string own_;
  std::int64_t own_run_id_;
  bool has_duplicate_ = false;
  std::map<std::string, HostState> hosts_;
  std::size_t hosts_max_ = 0;
};

}  // namespace vantage::tools
