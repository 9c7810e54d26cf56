#pragma once

namespace vantage {

/// Real-time settings requested from the operating system.
struct RealTime {
  int fifo_priority = 0;  ///< 1 … 99: SCHED_FIFO for the calling thread; 0: unchanged
  int cpu = -1;           ///< the only CPU of the calling thread; −1: any
  /// true: all pages are locked in memory, so that no page fault occurs later
  bool lock_memory = false;
};

/// Removes "--fifo PRIORITY", "--cpu N" and "--lock-memory" from the arguments and returns their
/// values.
/// @throws UsageError when a value is missing, not a number, or out of range.
RealTime take_real_time(int& argc, char** argv);

/// Applies the settings to the calling thread (memory: to the whole process).
/// @throws StartupError that names the refused setting and the remedy.
void apply(const RealTime& real_time);

/// True if the system grants SCHED_FIFO with `priority` to a thread of this process; tries it on a
/// temporary thread.
bool grants_fifo(int priority);

/// True if the calling thread has a real-time policy (SCHED_FIFO or SCHED_RR) that its child
/// processes inherit.
bool runs_in_real_time();

}  // namespace vantage
