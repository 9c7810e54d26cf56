#pragma once

#include <string>

#include <unistd.h>

namespace vantage::test {

/// Returns the UDP port of connection `number` of this process, `number` in [0, 3].
inline std::string port_of_this_test(int number) {
  return std::to_string(20'000 + (getpid() * 4 + number) % 20'000);
}

}  // namespace vantage::test
