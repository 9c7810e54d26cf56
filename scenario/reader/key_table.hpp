#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Rule of one key of a file: place, allowed values, default.
struct KeyRule {
  std::string path;          ///< "robots[].sensor.range_max_m"
  std::string values;        ///< "above 0 and at most 360", "one of arvi, beam", "list"
  std::string initial;       ///< value if the key is absent; empty: none, or set by another rule
  bool is_required = false;  ///< the reader refuses a file without it
  int line = 0;  ///< line of the key in the file, from 1; 0 if the file does not have it
};

/// List of all keys that a reader asks for, in the order in which it first does.
class KeyTable {
 public:
  /// Adds `rule`, or completes the rule of the same path. Indices in the path become "[]".
  void note(KeyRule rule);
  [[nodiscard]] const std::vector<KeyRule>& rules() const { return rules_; }

 private:
  std::vector<KeyRule> rules_;
};

}  // namespace vantage::scenario
