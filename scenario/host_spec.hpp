#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// One computer of a trial and the parts that it runs.
struct HostSpec {
  std::string name;               ///< channel suffix, [A-Z0-9]+
  std::vector<std::string> runs;  ///< robot names, "sim", "vicon", "logger"
};

/// Names of the parts other than robots that a host can run.
inline constexpr const char* kSimPart = "sim";
inline constexpr const char* kMocapPart = "vicon";
inline constexpr const char* kLoggerPart = "logger";

}  // namespace vantage::scenario
