#pragma once

#include <cstdlib>

namespace vantage::test {

/// True under qemu's user mode (`ctest --preset arm64`), which lacks some system calls: pseudo
/// terminals, time stamps of datagrams and the memory of processes.
inline bool is_emulated() { return std::getenv("QEMU_LD_PREFIX") != nullptr; }

}  // namespace vantage::test
