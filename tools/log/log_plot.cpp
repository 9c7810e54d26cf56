#include "tools/log/log_plot.hpp"

#include <chrono>

#include <fmt/format.h>

#include "tools/picture/picture.hpp"
#include "tools/supervisor/child.hpp"

namespace vantage::tools {
namespace {

constexpr const char* kMissing = "NaN";

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : kMissing;
}

/// Without what gnuplot would read as more than text.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '\'' ? "''" : std::string(1, c);
  }
  return "'" + out + "'";
}

}  // namespace

std::string plot_script(const logs::LogAnalysis& analysis, const std::string& title,
                        const std::string& png_path) {
  std::string out = "$course << EOD\n";
  for (const logs::CoursePoint& point : analysis.course) {
    out += fmt::format("{:.6f} {} {:.9g} {}\n", point.at_s, number(point.rmse_m),
                       point.entropy_nats, point.discovered);
  }
  out += "EOD\n";
  std::string margins;
  std::string gaps;
  int colour = 0;
  for (const auto& [robot, record] : analysis.deadlines) {
    out += fmt::format("$plans{} << EOD\n", ++colour);
    for (const logs::PlanPoint& plan : analysis.plans) {
      if (plan.robot == robot) {
        out +=
            fmt::format("{:.6f} {:.9g} {}\n", plan.at_s, 1e3 * plan.margin_s, number(plan.gap_nat));
      }
    }
    out += "EOD\n";
    const std::string style =
        fmt::format(" with points pt 7 ps 0.5 lc {} title {}", colour, quoted(robot));
    margins += fmt::format("{}$plans{} using 1:2{}", colour > 1 ? ", " : "", colour, style);
    gaps += fmt::format("{}$plans{} using 1:3{}", colour > 1 ? ", " : "", colour, style);
  }
  out += fmt::format(
      "set terminal pngcairo noenhanced size 1200,1500 font 'Sans,11'\n"
      "set output {}\n"
      "set grid lc rgb '#dddddd'\n"
      "set xrange [0:*]\n"
      "set key top right\n"
      "set lmargin 12\n"
      "set multiplot layout 5,1 title {}\n"
      "set yrange [0:*]\n"
      "set ylabel 'RMSE of known targets [m]'\n"
      "plot $course using 1:2 with lines lw 1.5 lc 1 notitle\n"
      "set yrange [*:*]\n"
      "set ylabel 'entropy a target [nat]'\n"
      "plot $course using 1:3 with lines lw 1.5 lc 2 notitle\n"
      "set yrange [0:{}]\n"
      "set ylabel 'targets found'\n"
      "plot $course using 1:4 with steps lw 1.5 lc 3 notitle\n"
      "set yrange [*:*]\n",
      quoted(png_path), quoted(title), analysis.summary.targets + 1);
  if (!analysis.deadlines.empty()) {
    out += "set ylabel 'margin to the deadline [ms]'\nplot " + margins + ", 0 lc 0 notitle\n";
    out += "set xlabel 'time since the first event [s]'\n";
    out += "set ylabel 'cost less bound [nat]'\nplot " + gaps + "\n";
  }
  return out + "unset multiplot\n";
}

Result<std::string> draw_plot(const std::string& script, const std::string& script_path,
                              const std::string& png_path) {
  write_text(script_path, script);
  Result<Child> child = Child::start({"gnuplot", script_path});
  if (!child.ok()) {
    return Error{"no plot: gnuplot is not installed (apt install gnuplot-nox)"};
  }
  const std::optional<ChildExit> ended = std::move(child).value().wait(std::chrono::seconds(60));
  if (!ended || !ended->is_success()) {
    return Error{"no plot: gnuplot failed on " + script_path};
  }
  return png_path;
}

}  // namespace vantage::tools
