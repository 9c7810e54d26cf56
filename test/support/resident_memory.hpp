#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "test/support/sanitizer.hpp"

namespace vantage::test {

/// Returns the resident memory of this process in KiB (VmRSS); 0 if /proc does not state it.
inline std::int64_t resident_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") {
      std::int64_t kib = 0;
      status >> kib;
      return kib;
    }
  }
  return 0;
}

/// True if a sanitizer keeps freed memory, which makes resident memory useless as a measure.
inline constexpr bool kKeepsFreedMemory = VANTAGE_IS_SANITIZED != 0;

}  // namespace vantage::test
