#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/write_file.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_plot.hpp"
#include "tools/log/range_recording.hpp"
#include "tools/log/range_report.hpp"

namespace vantage::tools {
namespace {

struct RangesArguments {
  std::string source;   ///< table of ranges (with `poses`), or log
  std::string poses;    ///< table of poses; empty: `source` is a log
  std::string beacons;  ///< survey; empty: none
  std::string robot;    ///< only robot to read from a log; empty: all
  std::optional<double> gap_max_s;
  double fitted_share = 0.7;
  std::string picture;  ///< empty: none
  bool as_json = false;
};

bool is_log(const std::string& path) {
  return std::filesystem::path(path).extension() == ".lcmlog";
}

RangeRecording read(const RangesArguments& arguments) {
  if (is_log(arguments.source)) {
    if (!arguments.poses.empty()) {
      throw StartupError("--poses is of a table of ranges; a log says where its robots were");
    }
    return recording_of(logs::IndexedLog(arguments.source, progress_line("reading")),
                        arguments.robot);
  }
  if (!arguments.robot.empty()) {
    throw StartupError("--robot is of a log; a table of ranges is of one robot");
  }
  Table ranges = read_ranges(arguments.source);
  if (arguments.poses.empty()) {
    throw StartupError(arguments.source +
                       ": where the robot was is not known; expected --poses POSES.csv");
  }
  return place_ranges(std::move(ranges), read_poses(arguments.poses), arguments.gap_max_s);
}

int fit(const RangesArguments& arguments) {
  if (!arguments.picture.empty()) {
    static_cast<void>(plot_terminal(arguments.picture));  // checks the name before reading files
    require_writable(arguments.picture);
  }
  const EndsAtOnce working;
  RangeRecording recording = read(arguments);
  const std::vector<Survey> surveys =
      arguments.beacons.empty() ? std::vector<Survey>() : read_survey(arguments.beacons);
  const RangeReport report =
      report_of(std::move(recording), surveys, arguments.fitted_share, arguments.source);
  if (arguments.as_json) {
    print_json(to_json(report));
  } else {
    for (const std::string& line : to_lines(report)) {
      print_line(line);
    }
  }
  if (arguments.picture.empty()) {
    return 0;
  }
  const std::string script = std::filesystem::path(arguments.picture).replace_extension(".gp");
  const Result<std::string> drawn =
      draw_plot(range_plot_script(report, arguments.picture), script, arguments.picture);
  if (!drawn.ok()) {
    print_line("vantage: " + drawn.error().message, stderr);
  }
  return drawn.ok() ? 0 : 1;
}

}  // namespace

void add_log_fit_ranges_command(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<RangesArguments>();
  CLI::App* command = log.add_subcommand(
      "fit-ranges", "Find beacons by ranges, with the ranging sensor's scale and bias.");
  command
      ->add_option("ranges", arguments->source,
                   "table (CSV) of time, beacon and range; or an LCM event log with MEASUREMENT_R "
                   "and SCENARIO, NAME.lcmlog, whose targets stand still")
      ->required();
  command->add_option("--poses", arguments->poses,
                      "table (CSV) of time, x and y: where the robot was");
  command->add_option("--beacons", arguments->beacons,
                      "table (CSV) of beacon, x and y: their survey, to be judged by");
  command->add_option("--robot", arguments->robot, "of a log: the ranges of this robot alone");
  command
      ->add_option("--gap-max-s", arguments->gap_max_s,
                   "between poses farther apart in time nothing is guessed; five times as far as "
                   "they usually are, and at least 1, when not given")
      ->check(positive_number());
  command
      ->add_option("--fitted-share", arguments->fitted_share,
                   "share of the time, from its start, that a second fit is of; the rest judges it")
      ->check(CLI::Range(0.1, 0.9))
      ->capture_default_str();
  command->add_option("--out", arguments->picture,
                      "also draw the beacons with 95 % ellipses and the residuals: .png, .svg or "
                      ".pdf, with gnuplot; its script lies beside it");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "A range is range_scale times the distance, plus range_bias_m, plus noise; some are\n"
      "outliers. Scale, bias and beacons are found together, from scales of 0.8 to 1.25 and "
      "biases\n"
      "of some metres on. 'sigma' is the longer half axis of a place's 1-sigma ellipse, 'noise' 1\n"
      "sigma of honest ranges. Columns are found by their headings (time_s, beacon_id, range_m; "
      "x_m,\ny_m), units in them are used: range_cm, time [ms]. Rows may be in any order.\n"
      "Examples:\n"
      "  vantage log fit-ranges ranges.csv --poses poses.csv --beacons survey.csv\n"
      "  vantage log fit-ranges flight.lcmlog --robot Q1 --json");
  command->callback([&chosen, arguments] { chosen = [arguments] { return fit(*arguments); }; });
}

}  // namespace vantage::tools
