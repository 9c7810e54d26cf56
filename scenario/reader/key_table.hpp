#pragma once

#include <string>
#include <vector>

namespace vantage::scenario {

/// Rule of one key of a file: path, allowed values and default.
struct KeyRule {
  std::string path;     ///< full path, such as "robots[].sensor.range_max_m"
  std::string values;   ///< allowed values: "above 0 and at most 360", "one of arvi, beam", "list"
  std::string initial;  ///< default value; empty: none, or determined by another key
  bool is_required = false;  ///< the reader refuses a file without this key
  int line = 0;              ///< line of the key in the file, from 1; 0 if the key is absent
};

/// List of all keys that a reader reads, in the order of the first read.
class KeyTable {
 public:
  /// Adds `rule`, or completes the existing rule with the same path. Indices in the path are
  /// replaced by "[]".
  void note(KeyRule rule);
  [[nodiscard]] const std::vector<KeyRule>& rules() const { return rules_; }

 private:
  std::vector<KeyRule> rules_;
};

}  // namespace vantage::scenario
