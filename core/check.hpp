#pragma once

#include <stdexcept>
#include <string>

namespace vantage {

/// The caller broke a documented precondition while building an object. Thrown at start-up only.
class UsageError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// A file, flag or device the process was started with cannot be used.
class StartupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws UsageError(`rule`) unless `holds`. For constructors and loaders, never in a loop.
void require(bool holds, const std::string& rule);

/// The same where nothing may be allocated while the rule holds.
inline void demand(bool holds, const char* rule) {
  if (!holds) {
    require(false, rule);
  }
}

}  // namespace vantage
