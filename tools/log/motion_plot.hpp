#pragma once

#include <string>
#include <vector>

#include "logs/motion/motion_fit.hpp"

namespace vantage::tools {

/// Returns the kind of a fitted model as in a scenario file.
std::string kind_word(const models::TargetModel& model);

/// Returns a gnuplot script with its data that draws into `picture_path`. The plot shows the
/// displacement of targets within a lag in the held-back time, measured and predicted by each
/// model, as root mean squares of both coordinates. Pure. @throws StartupError as plot_terminal().
std::string motion_plot_script(const std::vector<logs::FittedMotion>& fits,
                               const std::string& title, const std::string& picture_path);

}  // namespace vantage::tools
