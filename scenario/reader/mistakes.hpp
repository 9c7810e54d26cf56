#pragma once

#include <functional>
#include <string>
#include <vector>

namespace vantage::scenario {

/// Calls `read`. Within mistakes_of_scenario() an error that it throws is stored instead of passed
/// on, so the caller keeps the variable's value and continues.
void tolerate(const std::function<void()>& read);

/// Returns all mistakes of the scenario file at `path`, each "file:line: key: rule", by line; empty
/// if load_scenario() accepts it. Mistakes that follow from others may be among them.
std::vector<std::string> mistakes_of_scenario(const std::string& path);

}  // namespace vantage::scenario
