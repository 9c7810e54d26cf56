#pragma once

#include <memory>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::python {

/// Value of Python's vantage.Scenario. It is immutable, so trials can share it.
struct Scenario {
  scenario::Scenario value;
  std::string source;  ///< file, or its substitute in messages
};

}  // namespace vantage::python
