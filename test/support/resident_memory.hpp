#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "test/support/sanitizer.hpp"

namespace vantage::test {

/// Memory of this process that is in RAM, in KiB (VmRSS); 0 where /proc does not tell.
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

/// Whether a sanitizer keeps memory that was given back, so that what is resident says nothing.
inline constexpr bool kKeepsFreedMemory = VANTAGE_IS_SANITIZED != 0;

}  // namespace vantage::test
