#include "tools/log/log_plot.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/write_file.hpp"
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

/// Whether a picture ends as one of its kind does.
bool is_whole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string end = text.substr(text.size() - std::min<std::size_t>(text.size(), 16));
  return end.find("IEND") != std::string::npos || end.find("</svg>") != std::string::npos ||
         end.find("%%EOF") != std::string::npos;
}

}  // namespace

std::string plot_terminal(const std::string& picture_path) {
  std::string suffix = std::filesystem::path(picture_path).extension();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (suffix == ".png") {
    return "pngcairo noenhanced size 1200,1500 font 'Sans,11'";
  }
  if (suffix == ".svg") {
    return "svg noenhanced size 1200,1500 font 'Sans,11' background rgb 'white'";
  }
  if (suffix == ".pdf") {
    return "pdfcairo noenhanced size 12in,15in font 'Sans,11'";
  }
  throw StartupError(picture_path + ": a picture's name ends in .png, .svg or .pdf");
}

std::string plot_script(const logs::LogAnalysis& analysis, const std::string& title,
                        const std::string& picture_path) {
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
      "set terminal {}\n"
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
      plot_terminal(picture_path), quoted(picture_path), quoted(title),
      analysis.summary.targets + 1);
  if (!analysis.deadlines.empty()) {
    out += "set ylabel 'margin to the deadline [ms]'\nplot " + margins + ", 0 lc 0 notitle\n";
    out += "set xlabel 'time since the first event [s]'\n";
    out += "set ylabel 'cost less bound [nat]'\nplot " + gaps + "\n";
  }
  return out + "unset multiplot\n";
}

Result<std::string> draw_plot(const std::string& script, const std::string& script_path,
                              const std::string& picture_path) {
  write_file(script_path, script);
  Result<Child> child = Child::start({"gnuplot", script_path});
  if (!child.ok()) {
    return Error{"no plot: gnuplot is not installed (apt install gnuplot-nox)"};
  }
  const std::optional<ChildExit> ended = std::move(child).value().wait(std::chrono::seconds(60));
  // A full disk is nothing to gnuplot, which then ends well.
  if (!ended || !ended->is_success() || !is_whole(picture_path)) {
    std::remove(picture_path.c_str());
    return Error{picture_path + ": cannot be written: gnuplot failed on " + script_path};
  }
  return picture_path;
}

}  // namespace vantage::tools
