#pragma once

#include <map>
#include <string>
#include <vector>

namespace vantage::scenario {

/// Returns the keys whose values are not the same in all scenario texts, by full path
/// ("planner.algorithm"), with one value per text; "-" where a text lacks the key. Elements of a
/// list are compared as a whole. Precondition: valid scenario texts.
std::map<std::string, std::vector<std::string>> differing_keys(
    const std::vector<std::string>& texts);

}  // namespace vantage::scenario
