#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Processor time and memory used by one process.
struct ProcessUsage {
  std::int64_t cpu_us = 0;             ///< µs; processor time of all threads since the start
  std::int64_t memory_bytes = 0;       ///< resident memory at present
  std::int64_t memory_most_bytes = 0;  ///< largest resident memory so far; 0: unknown
};

/// Parses the text of /proc/PID/stat; nullopt when it is malformed. The text does not contain
/// `memory_most_bytes`, which is left 0.
/// @param ticks_per_s  unit of the processor time in the text, sysconf(_SC_CLK_TCK)
std::optional<ProcessUsage> usage_from_stat(std::string_view stat, std::int64_t ticks_per_s,
                                            std::int64_t page_bytes);

/// Returns the usage of the process `pid` on this machine; nullopt when the process has ended.
/// Processor time has a resolution of one clock tick (10 ms). Cost: reads one file, about 20 µs.
std::optional<ProcessUsage> usage_of(int pid);

/// Returns how long one thread was ready to run without a processor, µs, from the text of
/// /proc/PID/task/TID/schedstat. Returns nullopt if the text is malformed or the kernel does not
/// count this time.
std::optional<std::int64_t> waited_us_from_schedstat(std::string_view schedstat);

/// Returns the waiting time of all present threads of the process `pid`, µs; a thread that has just
/// ended is omitted. Returns nullopt if the process has ended or the kernel does not count this
/// time. Cost: reads one file per thread, about 7 µs each.
std::optional<std::int64_t> waited_us_of(int pid);

/// Reader of the time that the calling thread waited for a processor, for frequent reads without a
/// search of /proc. Cost: one pread on an open descriptor, about 2 µs.
class ThreadWait {
 public:
  /// Opens the counter of the calling thread.
  ThreadWait();
  ~ThreadWait();
  ThreadWait(const ThreadWait&) = delete;
  ThreadWait& operator=(const ThreadWait&) = delete;
  ThreadWait(ThreadWait&&) = delete;
  ThreadWait& operator=(ThreadWait&&) = delete;

  /// Returns how long the thread was ready to run without a processor since its start, µs; nullopt
  /// if the kernel does not count this time.
  [[nodiscard]] std::optional<std::int64_t> waited_us() const;

 private:
  int descriptor_ = -1;
};

/// Returns the usage of this process as counters for HEALTH: process.cpu_us, process.memory_bytes,
/// process.memory_most_bytes and, if the kernel counts it, process.waited_us.
std::vector<models::NamedCount> usage_counters();

}  // namespace vantage::bus
