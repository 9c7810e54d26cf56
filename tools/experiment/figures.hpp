#pragma once

#include <string>

// gnuplot scripts, each run in the directory of its experiment's files; SVG and PNG come out.

namespace vantage::tools {

std::string dls_savings_figure();
std::string dls_objective_figure();
std::string resilient_tracking_figure();

}  // namespace vantage::tools
