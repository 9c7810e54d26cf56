#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// What one process has taken of its machine.
struct ProcessUsage {
  std::int64_t cpu_us = 0;             ///< processor time of all its threads since its start
  std::int64_t memory_bytes = 0;       ///< resident now
  std::int64_t memory_most_bytes = 0;  ///< resident, the most so far; 0: not known
};

/// From the text of /proc/PID/stat; nullopt when it is none. `memory_most_bytes` is not in it.
/// @param ticks_per_s  of the processor time in it, sysconf(_SC_CLK_TCK)
std::optional<ProcessUsage> usage_from_stat(std::string_view stat, std::int64_t ticks_per_s,
                                            std::int64_t page_bytes);

/// Of the process `pid` on this machine; nullopt when it is gone. Reads one file: about 20 µs.
/// Processor time in steps of a clock tick (10 ms).
std::optional<ProcessUsage> usage_of(int pid);

/// How long one thread was ready to run and had no processor, µs, from the text of
/// /proc/PID/task/TID/schedstat; nullopt when it is none, or of a kernel that does not count it.
std::optional<std::int64_t> waited_us_from_schedstat(std::string_view schedstat);

/// Of all threads that the process `pid` has now (less, when one has ended); nullopt when it is
/// gone, or its kernel does not count it. Reads one file a thread: about 7 µs each.
std::optional<std::int64_t> waited_us_of(int pid);

/// The waiting time of the calling thread, read again and again without a search of /proc: one
/// pread on an open descriptor, about 2 µs.
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
  /// where the kernel does not count it.
  [[nodiscard]] std::optional<std::int64_t> waited_us() const;

 private:
  int descriptor_ = -1;
};

/// Of this process, as HEALTH carries it: process.cpu_us, process.memory_bytes,
/// process.memory_most_bytes and, where the kernel counts it, process.waited_us.
std::vector<models::NamedCount> usage_counters();

}  // namespace vantage::bus
