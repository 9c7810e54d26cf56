#include "core/check.hpp"
#include "python/binding/bind.hpp"
#include "python/binding/live.hpp"
#include "trial/observe/announcer.hpp"

PYBIND11_MODULE(_vantage, module) {
  namespace py = pybind11;
  using namespace vantage::python;  // NOLINT(google-build-using-namespace): lists its functions
  module.doc() = "Compiled part of the package vantage; see help(vantage).";
  module.attr("__version__") = vantage::trial::version();
  py::register_exception<vantage::StartupError>(module, "StartupError", PyExc_ValueError).doc() =
      "A file or text is invalid. The message states the location and what was expected.";
  py::register_exception<vantage::UsageError>(module, "UsageError", PyExc_ValueError).doc() =
      "An argument violates a rule. The message names the argument and the rule.";
  bind_models(module);
  bind_planning(module);
  bind_team(module);
  bind_scenario(module);
  bind_trial(module);
  bind_logs(module);
  bind_env(module);
  bind_live(module);
}
