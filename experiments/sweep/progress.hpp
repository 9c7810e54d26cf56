#pragma once

#include <cstddef>
#include <string>

namespace vantage::experiments {

/// Progress of one process: its units and the elapsed time.
struct SweepProgress {
  std::size_t units = 0;        ///< number of units of this process's share
  std::size_t done = 0;         ///< number of finished units of the share
  std::size_t done_before = 0;  ///< number of finished units that were read from files
  double elapsed_s = 0.0;
  bool is_stopping = false;
};

/// Returns a text such as "41 % 37 of 90 units, 3 min 20 s left". The estimate uses the mean time
/// of the units that this process has run; before the first of these units has ended, it is "…".
std::string progress_text(const SweepProgress& progress);

}  // namespace vantage::experiments
