#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Computer of a trial, with the parts of the trial that it runs.
struct HostSpec {
  std::string name;               ///< channel suffix, [A-Z0-9]+
  std::vector<std::string> runs;  ///< robot names, "sim", "vicon", "logger"
};

/// Names of the parts that a host can run in addition to robots.
inline constexpr const char* kSimPart = "sim";
inline constexpr const char* kMocapPart = "vicon";
inline constexpr const char* kLoggerPart = "logger";

}  // namespace vantage::scenario
