#pragma once

#include <memory>
#include <string>

#include "scenario/scenario.hpp"

namespace vantage::python {

/// What Python's vantage.Scenario holds: it never changes, so that trials may share it.
struct Scenario {
  scenario::Scenario value;
  std::string source;  ///< file, or what stands for it in messages
};

}  // namespace vantage::python
