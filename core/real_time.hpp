#pragma once

namespace vantage {

/// How the operating system is asked to treat this process.
struct RealTime {
  int fifo_priority = 0;     ///< 1 … 99: SCHED_FIFO for the calling thread; 0: as it is
  int cpu = -1;              ///< the only CPU that the calling thread runs on; −1: any
  bool lock_memory = false;  ///< no page of the process is ever swapped out or faulted in late
};

/// Takes "--fifo PRIORITY", "--cpu N" and "--lock-memory" out of the arguments.
/// @throws UsageError when a value is missing, no number, or out of range.
RealTime take_real_time(int& argc, char** argv);

/// Applies it to the calling thread (memory: to the whole process).
/// @throws StartupError naming what was refused and what would allow it.
void apply(const RealTime& real_time);

/// True if a thread of this process may be given SCHED_FIFO with `priority`: tried on a thread of
/// its own, which ends.
bool grants_fifo(int priority);

}  // namespace vantage
