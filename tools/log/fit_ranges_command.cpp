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
  std::string beacons;  ///< table of surveyed beacons; empty: none
  std::string robot;    ///< only robot to read from a log; empty: all robots
  std::optional<double> gap_max_s;
  double fitted_share = 0.7;
  std::string picture;  ///< path of the picture; empty: none
  bool as_json = false;
};

bool is_log(const std::string& path) {
  return std::filesystem::path(path).extension() == ".lcmlog";
}

RangeRecording read(const RangesArguments& arguments) {
  if (is_log(arguments.source)) {
    if (!arguments.poses.empty()) {
      throw StartupError("--poses is only for a table of ranges: a log contains the robots' poses");
    }
    return recording_of(logs::IndexedLog(arguments.source, progress_line("reading")),
                        arguments.robot);
  }
  if (!arguments.robot.empty()) {
    throw StartupError("--robot is only for a log: a table contains the ranges of one robot");
  }
  Table ranges = read_ranges(arguments.source);
  if (arguments.poses.empty()) {
    throw StartupError(arguments.source +
                       ": the poses of the robot are missing; expected --poses POSES.csv");
  }
  return place_ranges(std::move(ranges), read_poses(arguments.poses), arguments.gap_max_s);
}

int fit(const RangesArguments& arguments) {
  if (!arguments.picture.empty()) {
    static_cast<void>(plot_terminal(arguments.picture));  // checks the name before reading files
    require_writable(arguments.picture);
  }
  const DefaultSignalScope working;
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
      "fit-ranges", "Estimate beacon positions and a range sensor's scale and bias from ranges.");
  command
      ->add_option("ranges", arguments->source,
                   "table (CSV) with time, beacon and range; or an LCM event log NAME.lcmlog with "
                   "MEASUREMENT_R, SCENARIO and static targets")
      ->required();
  command->add_option(
      "--poses", arguments->poses,
      "table (CSV) with time, x and y of the robot; required with a table of ranges");
  command->add_option("--beacons", arguments->beacons,
                      "table (CSV) with beacon, x and y: surveyed positions to compare with");
  command->add_option("--robot", arguments->robot,
                      "with a log: use only the ranges of this robot; default: all robots");
  command
      ->add_option(
          "--gap-max-s", arguments->gap_max_s,
          "longest gap between poses, s; ranges in longer gaps are left out; default: five "
          "times the usual interval, at least 1")
      ->check(positive_number());
  command
      ->add_option(
          "--fitted-share", arguments->fitted_share,
          "share of the time, from the start, used for a second fit; the later ranges test "
          "this fit")
      ->check(CLI::Range(0.1, 0.9))
      ->capture_default_str();
  command->add_option("--out", arguments->picture,
                      "also plot the beacons with 95 % ellipses and the residuals: .png, .svg or "
                      ".pdf (needs gnuplot); the script is written next to it (.gp)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Model: range = range_scale * distance + range_bias_m + noise; some ranges are outliers.\n"
      "Scale (0.8 to 1.25), bias (-1.5 to 1.5 m) and beacons are estimated together. 'sigma' is\n"
      "the longer half axis of a position's 1-sigma ellipse, 'noise' is 1 sigma of the ranges\n"
      "without outliers. Columns are found by their headings (time_s, beacon_id, range_m; x_m,\n"
      "y_m); units in headings are used (range_cm, time [ms]). Rows may be in any order.\n"
      "Examples:\n"
      "  vantage log fit-ranges ranges.csv --poses poses.csv --beacons survey.csv\n"
      "  vantage log fit-ranges flight.lcmlog --robot Q1 --json");
  command->callback([&chosen, arguments] { chosen = [arguments] { return fit(*arguments); }; });
}

}  // namespace vantage::tools
