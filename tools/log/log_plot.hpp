#pragma once

#include <string>

#include "core/result.hpp"
#include "logs/analysis/log_analysis.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Returns gnuplot's terminal for a picture named .png, .svg or .pdf, in any letter case.
/// @throws StartupError for any other name.
std::string plot_terminal(const std::string& picture_path, int height_px = 1500);

/// Returns `text` quoted for gnuplot.
std::string gnuplot_text(const std::string& text);

/// Returns a gnuplot script with its data that draws the course of a trial into `picture_path`:
/// RMSE, entropy, discovered targets, deadline margins and gaps of the plans over time. Pure.
/// @throws StartupError as plot_terminal().
std::string plot_script(const logs::LogAnalysis& analysis, const scenario::Scenario& scenario,
                        const std::string& title, const std::string& picture_path);

/// Writes the script and runs gnuplot on it. Returns the picture's path; the Error states that
/// gnuplot is missing or has failed. An incomplete picture is removed.
Result<std::string> draw_plot(const std::string& script, const std::string& script_path,
                              const std::string& picture_path);

}  // namespace vantage::tools
