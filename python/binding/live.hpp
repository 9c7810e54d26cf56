#pragma once

#include <pybind11/pybind11.h>

namespace vantage::python {

/// vantage.live: the running system's channels.
void bind_live(pybind11::module_& module);

}  // namespace vantage::python
