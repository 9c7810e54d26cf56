#pragma once

#include <cstdint>

namespace vantage {

/// CPU time that the calling thread has used. May be asked in a signal handler.
std::int64_t thread_cpu_ns();
inline double thread_cpu_s() { return 1e-9 * static_cast<double>(thread_cpu_ns()); }

}  // namespace vantage
