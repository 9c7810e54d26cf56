#pragma once

#include <string>

#include "core/result.hpp"
#include "logs/analysis/log_analysis.hpp"

namespace vantage::tools {

/// A gnuplot script, data included, that draws the course of a trial into `png_path`: RMSE,
/// entropy, targets found, deadline margins and gaps of the plans, over time. Pure.
std::string plot_script(const logs::LogAnalysis& analysis, const std::string& title,
                        const std::string& png_path);

/// Runs gnuplot on it; the Error says what is missing.
Result<std::string> draw_plot(const std::string& script, const std::string& script_path,
                              const std::string& png_path);

}  // namespace vantage::tools
