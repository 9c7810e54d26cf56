#pragma once

#include <cstddef>
#include <string>

namespace vantage::experiments {

/// How far a process has come with its units.
struct SweepProgress {
  std::size_t units = 0;        ///< of this process's share
  std::size_t done = 0;         ///< of them
  std::size_t done_before = 0;  ///< of those done, the ones that were read back
  double elapsed_s = 0.0;
  bool is_stopping = false;
};

/// "41 % 37 of 90 units, 3 min 20 s left": as long again for each as for those run so far; "…" for
/// the time while none is done.
std::string progress_text(const SweepProgress& progress);

}  // namespace vantage::experiments
