#pragma once

#include <functional>
#include <string>
#include <vector>

namespace vantage::scenario {

/// Calls `read`. Within mistakes_of_scenario(), an error thrown by `read` is only stored: the
/// caller keeps the variable's value and continues.
void tolerate(const std::function<void()>& read);

/// Returns all mistakes of the scenario file at `path`, each "file:line: key: rule", by line; empty
/// if load_scenario() accepts it. The list may contain mistakes that only follow from other
/// mistakes.
std::vector<std::string> mistakes_of_scenario(const std::string& path);

}  // namespace vantage::scenario
