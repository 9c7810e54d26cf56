#include "models/scenario/scenario.hpp"

#include <algorithm>

namespace vantage::models {

const RobotSpec* Scenario::find_robot(const std::string& robot) const {
  const auto found = std::find_if(robots.begin(), robots.end(),
                                  [&](const RobotSpec& spec) { return spec.name == robot; });
  return found == robots.end() ? nullptr : &*found;
}

}  // namespace vantage::models
