#include "tools/log/motion_plot.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tools/log/log_plot.hpp"

namespace vantage::tools {

std::string motion_plot_script(const std::vector<logs::FittedMotion>& fits,
                               const std::string& title, const std::string& picture_path) {
  std::string out;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    out += fmt::format("$coordinate{} << EOD\n", axis);
    for (std::size_t h = 0; h < logs::kHorizons_s.size(); ++h) {
      const auto of = [&](const logs::FittedMotion& fit) {
        return fit.held_back.displacements[axis][h];
      };
      out +=
          fmt::format("{:g} {:.9g}", logs::kHorizons_s[h], std::sqrt(of(fits.front()).observed_m2));
      for (const logs::FittedMotion& fit : fits) {
        out += fmt::format(" {:.9g}", std::sqrt(of(fit).predicted_m2));
      }
      out += "\n";
    }
    out += "EOD\n";
  }
  out += fmt::format(
      "set terminal {}\nset output {}\nset grid lt 1 lc rgb '#dddddd'\n"
      "set colorsequence podo\nset key left top Left reverse\n"
      "set xrange [0:*]\nset yrange [0:*]\nset xlabel 'time ahead, s'\n"
      "set multiplot layout 1,2 title {}\n",
      plot_terminal(picture_path, 600), gnuplot_text(picture_path), gnuplot_text(title));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    out +=
        fmt::format("set ylabel 'RMS displacement in {}, m'\nplot $coordinate{}", "xy"[axis], axis);
    out += " using 1:2 with points pt 7 ps 1.2 lt 1 title 'measured'";
    for (std::size_t m = 0; m < fits.size(); ++m) {
      out += fmt::format(", '' using 1:{} with lines lw 2 lt {} title {}", m + 3, m + 2,
                         gnuplot_text(std::string(fits[m].model.kind.name())));
    }
    out += "\n";
  }
  return out + "unset multiplot\n";
}

}  // namespace vantage::tools
