#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "localizer/judge/judge.hpp"

namespace vantage::tools {

/// Returns the figures as lines of text. `robots`: names in the order of the figures.
std::vector<std::string> to_lines(const localizer::JudgeFigures& figures,
                                  const std::vector<std::string>& robots);

/// Returns the figures with full precision.
nlohmann::ordered_json to_json(const localizer::JudgeFigures& figures,
                               const std::vector<std::string>& robots);

}  // namespace vantage::tools
