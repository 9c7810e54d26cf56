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
#include "core/child.hpp"
#include "core/write_file.hpp"
#include "logs/appearance/appearance.hpp"
#include "logs/picture/picture.hpp"

namespace vantage::tools {
namespace {

constexpr const char* kMissing = "NaN";

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : kMissing;
}

/// True if a picture ends with the end marker of a PNG, SVG or PDF file.
bool is_whole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string end = text.substr(text.size() - std::min<std::size_t>(text.size(), 16));
  return end.find("IEND") != std::string::npos || end.find("</svg>") != std::string::npos ||
         end.find("%%EOF") != std::string::npos;
}

// Returns the index of a robot in the scenario, which determines its colour.
std::size_t index_of_robot(const scenario::Scenario& scenario, const std::string& robot) {
  const auto is_it = [&](const scenario::RobotSpec& each) { return each.name == robot; };
  return static_cast<std::size_t>(
      std::find_if(scenario.robots.begin(), scenario.robots.end(), is_it) -
      scenario.robots.begin());
}

const std::string& paint(const char* role) { return logs::appearance().roles.at(role).light; }
std::string label(const char* measure) { return logs::appearance().measures.at(measure).title(); }

}  // namespace

std::string plot_terminal(const std::string& picture_path, int height_px) {
  std::string suffix = std::filesystem::path(picture_path).extension();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (suffix == ".png") {
    return fmt::format("pngcairo noenhanced size 1400,{} font 'Sans,11'", height_px);
  }
  if (suffix == ".svg") {
    return fmt::format("svg noenhanced size 1400,{} font 'Sans,11' background rgb 'white'",
                       height_px);
  }
  if (suffix == ".pdf") {
    return fmt::format("pdfcairo noenhanced size 14in,{}in font 'Sans,11'", 0.01 * height_px);
  }
  throw StartupError(picture_path + ": the name of a picture must end in .png, .svg or .pdf");
}

std::string gnuplot_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '\'' ? "''" : std::string(1, c);
  }
  return "'" + out + "'";
}

// Long function: it writes one script from top to bottom.
std::string plot_script(const logs::LogAnalysis& analysis, const scenario::Scenario& scenario,
                        const std::string& title, const std::string& picture_path) {
  std::string out = "$course << EOD\n";
  for (const logs::CoursePoint& point : analysis.course) {
    out += fmt::format("{:.6f} {} {:.9g} {}\n", point.at_s, number(point.rmse_m),
                       point.entropy_nats, point.discovered);
  }
  out += "EOD\n";
  std::string margins;
  std::string gaps;
  std::size_t robot_index = 0;
  for (const auto& [robot, record] : analysis.deadlines) {
    out += fmt::format("$plans{} << EOD\n", robot_index);
    for (const logs::PlanPoint& plan : analysis.plans) {
      if (plan.robot == robot) {
        out +=
            fmt::format("{:.6f} {:.9g} {}\n", plan.at_s, 1e3 * plan.margin_s, number(plan.gap_nat));
      }
    }
    out += "EOD\n";
    const logs::RobotAppearance appearance =
        logs::robot_appearance(index_of_robot(scenario, robot));
    const std::string style =
        fmt::format(" with linespoints pt 7 ps 0.4 lw 1 lc rgb '{}' dt {} title {}",
                    appearance.body_paint().light, appearance.dash + 1, gnuplot_text(robot));
    const char* comma = robot_index > 0 ? ", " : "";
    margins += fmt::format("{}$plans{} using 1:2{}", comma, robot_index, style);
    gaps += fmt::format("{}$plans{} using 1:3{}", comma, robot_index, style);
    ++robot_index;
  }
  const bool has_plans = !analysis.deadlines.empty();
  // A legend with many names has several columns.
  const std::size_t key_columns = robot_index / 13 + 1;
  // All charts have equal margins, so that an instant is at the same x position in each of them.
  // The legend is outside, where it covers no line.
  out += fmt::format(
      "set terminal {terminal}\n"
      "set output {output}\n"
      "set grid lt 1 lc rgb '#dddddd'\n"
      "set border lc rgb '{quiet}'\n"
      "set tics textcolor rgb '{ink}'\n"
      "set xrange [0:*]\n"
      "set key outside right top vertical Left reverse maxcols {columns} samplen 2\n"
      "set lmargin 13\n"
      "set rmargin {right}\n"
      "set multiplot layout {rows},1 title {title}\n"
      "set yrange [0:*]\n"
      "set ylabel '{rmse}'\n"
      "plot $course using 1:2 with lines lw 1.5 lc rgb '{ink}' notitle\n"
      "set yrange [*:*]\n"
      "set ylabel '{entropy}'\n"
      "plot $course using 1:3 with lines lw 1.5 lc rgb '{ink}' notitle\n"
      "set yrange [0:{found_max}]\n"
      "{last_label}set ylabel '{found}'\n"
      "plot $course using 1:4 with steps lw 1.5 lc rgb '{ink}' notitle\n"
      "set yrange [*:*]\n",
      fmt::arg("terminal", plot_terminal(picture_path, has_plans ? 1500 : 900)),
      fmt::arg("output", gnuplot_text(picture_path)), fmt::arg("quiet", paint("wall")),
      fmt::arg("ink", paint("truth")), fmt::arg("columns", key_columns),
      fmt::arg("right", has_plans ? 3 + 9 * key_columns : 3), fmt::arg("rows", has_plans ? 5 : 3),
      fmt::arg("title", gnuplot_text(title)), fmt::arg("rmse", label("rmse")),
      fmt::arg("entropy", label("entropy")), fmt::arg("found_max", analysis.summary.targets + 1),
      fmt::arg("found", label("found")),
      fmt::arg("last_label",
               has_plans ? std::string() : fmt::format("set xlabel '{}'\n", label("time"))));
  if (has_plans) {
    out += fmt::format("set ylabel '{}'\nplot {}, 0 lc rgb '{}' notitle\n", label("margin"),
                       margins, paint("jammed"));
    out += fmt::format("set xlabel '{}'\nset ylabel '{}'\nplot {}\n", label("time"), label("gap"),
                       gaps);
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
  // gnuplot ends with exit code 0 even if the disk is full, so the picture is checked.
  if (!ended || !ended->is_success() || !is_whole(picture_path)) {
    std::remove(picture_path.c_str());
    return Error{picture_path + ": cannot be written: gnuplot failed on " + script_path};
  }
  return picture_path;
}

}  // namespace vantage::tools
