#pragma once

#include <cstdint>
#include <fstream>
#include <string>

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
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kKeepsFreedMemory = true;
#else
inline constexpr bool kKeepsFreedMemory = false;
#endif

}  // namespace vantage::test
