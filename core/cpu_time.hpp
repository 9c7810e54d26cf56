#pragma once

#include <cstdint>

namespace vantage {

/// Returns the CPU time used by the calling thread. Safe in a signal handler.
std::int64_t thread_cpu_ns();
inline double thread_cpu_s() { return 1e-9 * static_cast<double>(thread_cpu_ns()); }

}  // namespace vantage
