#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scenario/scenario.hpp"
#include "tools/up/up.hpp"

namespace vantage::tools {

/// Time that all processors of a machine have spent, in clock ticks since its start.
struct ProcessorTimes {
  std::int64_t free = 0;  ///< idle, or at work of a low priority (nice)
  std::int64_t total = 0;
};

/// From the text of /proc/stat; nullopt when it is not such a text.
std::optional<ProcessorTimes> processor_times(std::string_view stat);

/// What a host gives to drivers: a priority, or else time.
struct HostReadiness {
  bool grants_priority = false;  ///< SCHED_FIFO with kDriverPriority
  /// Number of processors that were free while `vantage up` listened; nullopt: not measured.
  std::optional<double> free_processors;
};

/// SCHED_FIFO priority of vehicle drivers and of the mocap driver.
inline constexpr int kDriverPriority = 50;
/// What has to be free where no priority is granted, in processors.
inline constexpr double kFreeProcessorsMin = 0.5;

/// Mean number of free processors between two readings of a machine with `processors`; nullopt
/// when no time has passed between them.
std::optional<double> free_processors(const ProcessorTimes& before, const ProcessorTimes& after,
                                      unsigned processors);

/// Why drivers would be late on this host, and what helps; nullopt: they have what they need, or it
/// could not be measured.
std::optional<std::string> host_fault(const HostReadiness& host);

/// Measures, from its construction on, how many processors of this machine are free.
class LoadMeter {
 public:
  LoadMeter();
  [[nodiscard]] std::optional<double> free_processors() const;

 private:
  std::optional<ProcessorTimes> begin_;
};

/// Returns `options` with a priority for drivers where the system grants it. Without drivers
/// nothing is changed or checked; a busy host that grants none is a warning without `fly`.
/// @throws StartupError when `fly` is asked for on a host on which drivers would be late.
UpOptions with_priority(const scenario::Scenario& scenario, UpOptions options,
                        const LoadMeter& load);

}  // namespace vantage::tools
