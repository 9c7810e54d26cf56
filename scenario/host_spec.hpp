#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// One computer of a trial and what it runs there.
struct HostSpec {
  std::string name;               ///< channel suffix, [A-Z0-9]+
  std::vector<std::string> runs;  ///< robots' names, "sim", "vicon", "logger"
};

/// What a host may run besides robots.
inline constexpr const char* kSimPart = "sim";
inline constexpr const char* kMocapPart = "vicon";
inline constexpr const char* kLoggerPart = "logger";

}  // namespace vantage::scenario
