#pragma once

#include <pybind11/pybind11.h>

namespace vantage::python {

/// Adds the classes of vantage.live, which gives access to the channels of the running system.
void bind_live(pybind11::module_& module);

}  // namespace vantage::python
