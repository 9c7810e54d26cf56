#pragma once

#include <memory>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::python {

/// C++ object behind Python's vantage.Scenario. It is immutable, so trials can share it.
struct Scenario {
  scenario::Scenario value;
  std::string source;  ///< file name, or the text that replaces it in messages
};

}  // namespace vantage::python
