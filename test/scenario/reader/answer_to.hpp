#pragma once

#include <string>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

// answer_to() and its variants return "taken" if the scenario is accepted, otherwise the whole
// error message.

namespace vantage::test {

inline const std::string kWorld = "name: x\nworld: {bounds: {min_m: [-9, -5], max_m: [9, 5]}}\n";
inline const std::string kTargets = "targets: {count: 1}\n";
inline const std::string kDefaults = "robot_defaults: {primitives: lab, sensor: {kind: range}}\n";

inline std::string answer_to(const std::string& text) {
  try {
    static_cast<void>(scenario::parse_scenario(text, "f"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

/// Returns the result for a team; its list `robots` begins on line 6.
inline std::string answer_to_team(const std::string& robots, const std::string& more = "") {
  return answer_to(kWorld + kTargets + kDefaults + "robots:\n" + robots + more);
}

/// Returns the result for one robot with `keys` on line 6 and `more` from line 7 on.
inline std::string answer_to_robot(const std::string& keys, const std::string& more = "") {
  return answer_to_team("  - {name: A, start: {x_m: 2, y_m: 2}" + keys + "}\n", more);
}

inline std::string answer_to_two(const std::string& of_a, const std::string& of_b,
                                 const std::string& more = "") {
  return answer_to_team("  - {name: A" + of_a + "}\n  - {name: B" + of_b + "}\n", more);
}

}  // namespace vantage::test
