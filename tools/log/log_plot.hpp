#pragma once

#include <string>

#include "core/result.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// gnuplot's terminal for a picture of that name: .png, .svg or .pdf, capitals or not.
/// @throws StartupError for any other.
std::string plot_terminal(const std::string& picture_path, int height_px = 1500);

/// `text` as a string of gnuplot's, without what it would read as more than text.
std::string gnuplot_text(const std::string& text);

/// A gnuplot script, data included, that draws the course of a trial into `picture_path`: RMSE,
/// entropy, targets found, deadline margins and gaps of the plans, over time. Pure.
/// @throws StartupError as plot_terminal().
std::string plot_script(const logs::LogAnalysis& analysis, const scenario::Scenario& scenario,
                        const std::string& title, const std::string& picture_path);

/// Runs gnuplot on it; the Error says what is missing, or what could not be drawn. No part of a
/// picture is left.
Result<std::string> draw_plot(const std::string& script, const std::string& script_path,
                              const std::string& picture_path);

}  // namespace vantage::tools
