#pragma once

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

  /// @param own  the host that this supervisor is
  HostBoard(const scenario::Scenario& scenario, std::string own, std::int64_t own_run_id,
            Time start);

  /// What there is to say about it: a host that came (again), one that speaks under our own name.
  std::optional<std::string> on_report(const models::HostReport& report, Time now);
  /// Hosts that have fallen silent since the last asking, one sentence each.
  std::vector<std::string> fallen_silent(Time now);
  /// One line for each process of each host, one for each host of which nothing is known.
  [[nodiscard]] std::vector<std::string> table(Time now) const;
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
};

}  // namespace vantage::tools
