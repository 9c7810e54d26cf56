#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "core/write_file.hpp"
#include "localizer/fit/blind_fit.hpp"
#include "localizer/fit/sensor_fit.hpp"
#include "scenario/reader/localizer_text.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/team_recording.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::tools {
namespace {

struct FitSensorArguments {
  std::string source;
  std::string parameters;  ///< scenario file; empty: start from the parameters of the log
  std::string output;      ///< scenario to write; empty: the section is printed
  bool is_without_truth = false;
  bool as_json = false;
};

/// Fits of one robot.
struct RobotFit {
  std::string robot;
  localizer::SensorFit sensor;
  localizer::DriveFit drive;
  bool has_drive = false;  ///< false: the odometry consists of increments, not commands
};

bool is_commanded(const localizer::RobotRecording& robot) {
  return robot.odometry.front().kind == models::OdometryKind::kCommand;
}

/// Fits all robots without true poses and writes the fitted sensors and drives to `team`.
std::vector<RobotFit> fit_team_without_truth(TeamRecording& team) {
  localizer::BlindFit blind;
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    if (!is_commanded(team.recording[robot])) {
      throw StartupError(team.source + ": the odometry of robot " + team.spec.robots[robot].name +
                         " consists of increments; --without-truth needs commands");
    }
  }
  try {
    blind = localizer::fit_without_truth(team.spec, team.recording);
  } catch (const UsageError& error) {
    throw StartupError(team.source + ": " + error.what());
  }
  std::vector<RobotFit> fits;
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    fits.push_back({team.spec.robots[robot].name, blind.sensors[robot], blind.drives[robot], true});
  }
  return fits;
}

/// Fits all robots with their true poses and writes the fitted sensors and drives to `team`.
std::vector<RobotFit> fit_team(TeamRecording& team) {
  require_truth(team);
  std::vector<RobotFit> fits;
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    scenario::LocalizedRobotSpec& spec = team.spec.robots[robot];
    RobotFit& fit = fits.emplace_back();
    fit.robot = spec.name;
    try {
      fit.sensor = localizer::fit_sensor(team.spec.landmarks, team.recording[robot]);
      fit.has_drive = is_commanded(team.recording[robot]);
      if (fit.has_drive) {
        fit.drive = localizer::fit_drive(team.recording[robot]);
        spec.drive = fit.drive.drive;
      }
    } catch (const UsageError& error) {
      throw StartupError(team.source + ": robot " + spec.name + ": " + error.what());
    }
    spec.sightings = fit.sensor.sensor;
  }
  return fits;
}

std::vector<std::string> lines_of_fits(const std::vector<RobotFit>& fits) {
  std::vector<std::string> lines;
  lines.push_back(
      fmt::format("{:<6} {:>9} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8} "
                  "{:>8} {:>7}",
                  "robot", "sightings", "range is", "loss", "other", "scale", "offset", "forward",
                  "stamp", "range", "bearing", "outliers", "found"));
  lines.push_back(
      fmt::format("{:<6} {:>9} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8} "
                  "{:>8} {:>7}",
                  "", "", "", "", "", "", "m", "m", "delay, s", "sigma, m", "sigma", "%", "%"));
  for (const RobotFit& fit : fits) {
    const localizer::SensorFit& s = fit.sensor;
    const bool is_depth = s.sensor.range_is_depth;
    lines.push_back(fmt::format(
        "{:<6} {:>9} {:>9} {:>7.2f} {:>7.2f} {:>7.4f} {:>7.3f} {:>7.3f} {:>8.4f} {:>8.4f} "
        "{:>8.4f} {:>8.2f} {:>7.1f}",
        fit.robot, s.sightings, is_depth ? "a depth" : "distance",
        is_depth ? s.depth_loss : s.distance_loss, is_depth ? s.distance_loss : s.depth_loss,
        s.sensor.range_scale, s.sensor.range_offset_m, s.sensor.forward_m, s.sensor.stamp_delay_s,
        s.range_sigma_m, s.bearing_sigma_rad, 100.0 * s.outliers, 100.0 * s.detection_probability));
  }
  lines.emplace_back();
  for (const RobotFit& fit : fits) {
    if (!fit.has_drive) {
      lines.push_back(fit.robot + ": the odometry consists of increments, so no drive is fitted");
      continue;
    }
    const scenario::DriveSpec& d = fit.drive.drive;
    lines.push_back(fmt::format(
        "{}: commands act after {:.3f} s with a lag of {:.3f} s; speed scale {:.3f}, turn scale "
        "{:.3f}, turn bias {:.4f} rad/s",
        fit.robot, d.delay_s, d.lag_s, d.speed_scale, d.turn_scale, d.turn_bias_radps));
  }
  return lines;
}

nlohmann::ordered_json sensors_to_json(const std::vector<RobotFit>& fits) {
  nlohmann::ordered_json json;
  for (const RobotFit& fit : fits) {
    const localizer::SensorFit& s = fit.sensor;
    nlohmann::ordered_json one = {{"robot", fit.robot},
                                  {"sightings", s.sightings},
                                  {"range_is_depth", s.sensor.range_is_depth},
                                  {"depth_loss", s.depth_loss},
                                  {"distance_loss", s.distance_loss},
                                  {"range_scale", s.sensor.range_scale},
                                  {"range_offset_m", s.sensor.range_offset_m},
                                  {"axis_rad", s.sensor.axis_rad},
                                  {"bearing_offset_rad", s.sensor.bearing_offset_rad},
                                  {"forward_m", s.sensor.forward_m},
                                  {"stamp_delay_s", s.sensor.stamp_delay_s},
                                  {"range_sigma_m", s.range_sigma_m},
                                  {"range_sigma_per_m", s.range_sigma_per_m},
                                  {"bearing_sigma_rad", s.bearing_sigma_rad},
                                  {"outliers", s.outliers},
                                  {"detection_probability", s.detection_probability}};
    if (fit.has_drive) {
      const scenario::DriveSpec& d = fit.drive.drive;
      one["drive"] = {{"delay_s", d.delay_s},
                      {"lag_s", d.lag_s},
                      {"speed_scale", d.speed_scale},
                      {"turn_scale", d.turn_scale},
                      {"turn_bias_radps", d.turn_bias_radps},
                      {"turn_sigma_rad", fit.drive.turn_sigma_rad},
                      {"move_sigma_m", fit.drive.move_sigma_m}};
    }
    json["robots"].push_back(one);
  }
  return json;
}

/// Returns the scenario `yaml` with `section` in place of its section localizer.
std::string with_section(const std::string& yaml, const std::string& section) {
  std::istringstream lines(yaml);
  std::string text;
  bool is_inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.front() != ' ' && line.front() != '#') {
      is_inside = line.starts_with("localizer:");
    }
    if (!is_inside) {
      text += line + '\n';
    }
  }
  return text + section;
}

int fit_sensors(const FitSensorArguments& arguments) {
  if (!arguments.output.empty()) {
    require_writable(arguments.output);
  }
  const DefaultSignalScope working;
  TeamRecording team = read_team(arguments.source);
  if (!arguments.parameters.empty()) {
    use_parameters(trial::scenario_path(arguments.parameters), team);
  }
  const std::vector<RobotFit> fits =
      arguments.is_without_truth ? fit_team_without_truth(team) : fit_team(team);
  const std::string section = scenario::localizer_text(team.spec);
  if (arguments.as_json) {
    print_json(sensors_to_json(fits));
  } else {
    for (const std::string& line : lines_of_fits(fits)) {
      print_line(line);
    }
  }
  if (!arguments.output.empty()) {
    write_file(arguments.output, with_section(team.yaml, section));
  } else if (!arguments.as_json) {
    print_line("");
    fmt::print("{}", section);
  }
  return 0;
}

}  // namespace

void add_log_fit_sensor_command(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<FitSensorArguments>();
  CLI::App* command = log.add_subcommand(
      "fit-sensor",
      "Fit the sensors and drives of robots that observe landmarks, for the section localizer.");
  command
      ->add_option("log", arguments->source,
                   "LCM event log with SCENARIO, ODOMETRY_R, SIGHTINGS_R and VICON or TRUTH; or a "
                   "folder of the MRCLAM data set")
      ->required();
  command->add_option("--scenario", arguments->parameters,
                      "scenario with the noise of the section localizer; default: that of the log");
  command->add_option(
      "--out", arguments->output,
      "scenario to write: that of the log with the fitted section; default: only the "
      "section is printed");
  command->add_flag("--without-truth", arguments->is_without_truth,
                    "use no true poses: alternate between estimating all paths in hindsight and "
                    "fitting to these paths; the stamp delay keeps its value in the scenario");
  command->add_flag("--json", arguments->as_json, "print one JSON object instead of the section");
  command->footer(
      "Two models of the range are fitted: the distance, and the depth along the sensor's axis. "
      "'loss'\n"
      "is the mean error of the better model, 'other' that of the other model. 'forward' is the\n"
      "sensor's position on the body's x axis, 'found' the share of landmarks in view that were\n"
      "detected, 'outliers' the share of errors above 6 sigma. Odometry of commands also gives "
      "the\n"
      "drive: delay, lag, scales and bias. The noise in the section is not fitted: it contains an\n"
      "allowance for errors that are correlated in time.\n"
      "Examples:\n"
      "  vantage log fit-sensor six.lcmlog\n"
      "  vantage log fit-sensor MRCLAM_Dataset6 --out fitted.yaml\n"
      "  vantage log fit-sensor six.lcmlog --without-truth");
  command->callback(
      [&chosen, arguments] { chosen = [arguments] { return fit_sensors(*arguments); }; });
}

}  // namespace vantage::tools
