#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scenario/scenario.hpp"
#include "tools/up/up.hpp"

namespace vantage::tools {

/// Processor time since the start of a machine, summed over its processors, in clock ticks.
struct ProcessorTimes {
  std::int64_t free = 0;  ///< idle, waiting for a disk, or in processes of low priority (nice)
  std::int64_t total = 0;
};

/// Parses the text of /proc/stat; nullopt if it has another format.
std::optional<ProcessorTimes> processor_times(std::string_view stat);

/// Ability of a host to run drivers in time: by a real-time priority or by free processors.
struct HostReadiness {
  /// The system grants SCHED_FIFO with kDriverPriority, or drivers inherit a real-time policy.
  bool has_priority = false;
  /// Mean number of processors that were free while `vantage up` listened; nullopt: not measured.
  std::optional<double> free_processors;
};

/// SCHED_FIFO priority of vehicle drivers and of the mocap driver.
inline constexpr int kDriverPriority = 50;
/// Minimum number of free processors on a host that grants no priority.
inline constexpr double kFreeProcessorsMin = 0.5;

/// Returns the mean number of free processors between two readings of a machine with `processors`;
/// nullopt if no time has passed between them.
std::optional<double> free_processors(const ProcessorTimes& before, const ProcessorTimes& after,
                                      unsigned processors);

/// Returns the reason why drivers would be late on this host, and the remedy; nullopt if they would
/// be in time or if this could not be measured.
std::optional<std::string> host_fault(const HostReadiness& host);

/// Measures the mean number of free processors of this machine since its construction.
class LoadMeter {
 public:
  LoadMeter();
  [[nodiscard]] std::optional<double> free_processors() const;

 private:
  std::optional<ProcessorTimes> begin_;
};

/// Returns `options` with a priority for drivers if the system grants it. Returns `options`
/// unchanged if the scenario has no drivers. Prints a warning if drivers would be late on this
/// host.
/// @throws StartupError instead of the warning if `fly` is set and `ignore_load` is not.
UpOptions with_priority(const scenario::Scenario& scenario, UpOptions options,
                        const LoadMeter& load);

}  // namespace vantage::tools
