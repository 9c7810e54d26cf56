#pragma once

#include <string>
#include <vector>

#include "logs/motion/motion_fit.hpp"

namespace vantage::tools {

/// Returns a gnuplot script with its data that draws into `picture_path`. The plot shows the
/// root mean square displacement of targets over the prediction horizon, as measured in the
/// held-out part of the logs and as predicted by each model. Pure.
/// @throws StartupError as plot_terminal().
std::string motion_plot_script(const std::vector<logs::FittedMotion>& fits,
                               const std::string& title, const std::string& picture_path);

}  // namespace vantage::tools
