#pragma once

#include <string>
#include <vector>

#include "logs/motion/motion_fit.hpp"

namespace vantage::tools {

/// The kind of a fitted model as a scenario file has it.
std::string kind_word(const models::TargetModel& model);

/// A gnuplot script, data included, that draws into `picture_path` how far targets got within a lag
/// in the time held back, and how far each model expects them to get: root mean squares of both
/// coordinates. Pure. @throws StartupError as plot_terminal().
std::string motion_plot_script(const std::vector<logs::FittedMotion>& fits,
                               const std::string& title, const std::string& picture_path);

}  // namespace vantage::tools
