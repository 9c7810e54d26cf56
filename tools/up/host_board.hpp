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

/// The name on HOST_* of the only host of a scenario without `hosts`.
inline constexpr const char* kOnlyHost = "LOCAL";

/// Makes shares of processor time from readings of how much has been used. Pure.
class UsageMeter {
 public:
  struct Reading {
    std::int64_t cpu_us = 0;
    std::int64_t memory_bytes = 0;
  };
  /// Puts the usage of the process `status.pid`, as read at `now`, into `process`; of one that does
  /// not run (no reading) nothing. The share is over at least half a second, else the last one.
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

/// What all supervisors of a trial say of their processes: who is silent, what is down. Pure.
class HostBoard {
 public:
  static constexpr double kSilentAfter_s = 3.0;
  static constexpr std::size_t kOtherHostsMax = 32;   ///< that the scenario does not name
  static constexpr std::size_t kProcessesMax = 1024;  ///< that are kept of one report

  /// @param own  the host that this supervisor is
  HostBoard(const scenario::Scenario& scenario, std::string own, std::int64_t own_run_id,
            Time start);

  /// Returns what there is to say about it: a host that came (again), one that speaks under our own
  /// name. Ignores, and counts, hosts for which there is no room.
  std::optional<std::string> on_report(const models::HostReport& report, Time now);
  /// Hosts that have fallen silent since the last asking, one sentence each.
  std::vector<std::string> fallen_silent(Time now);
  /// One line for each process of each host, one for each host of which nothing is known.
  [[nodiscard]] std::vector<std::string> table(Time now) const;
  /// Reports of hosts for which there was no room.
  [[nodiscard]] std::int64_t ignored() const { return ignored_; }
  /// "LAB 7/7, AIR silent for 4 s": running and to run; empty with one host all of which runs.
  [[nodiscard]] std::string line(Time now) const;

 private:
  struct Heard {
    std::optional<models::HostReport> report;
    Time at{};
    bool is_silent = false;
  };
  std::string own_;
  std::int64_t own_run_id_;
  bool has_rival_ = false;
  std::map<std::string, Heard> hosts_;
  std::size_t hosts_max_ = 0;
  std::int64_t ignored_ = 0;
};

}  // namespace vantage::tools
