#pragma once

#include <stdexcept>
#include <string>

namespace vantage {

/// Violation of a documented precondition while an object is built. Thrown at start-up only.
class UsageError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Error at the start of a process: an unusable file, flag or device.
class StartupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws UsageError(`rule`) unless `holds`. For constructors and loaders only, because every call
/// may allocate.
void require(bool holds, const std::string& rule);

/// As require(), without an allocation while `holds` is true.
inline void demand(bool holds, const char* rule) {
  if (!holds) {
    require(false, rule);
  }
}

}  // namespace vantage
