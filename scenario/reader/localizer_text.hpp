#pragma once

#include <string>

#include "scenario/localizer_spec.hpp"

namespace vantage::scenario {

/// Returns the section `localizer` of a scenario file with all keys of `spec`. parse_localizer()
/// reads the same values, rounded to 6 significant digits; positions are rounded to 1 µm.
std::string localizer_text(const LocalizerSpec& spec);

}  // namespace vantage::scenario
