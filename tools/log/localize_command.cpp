#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "core/write_file.hpp"
#include "localizer/judge/judge.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/localize_report.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/team_recording.hpp"
#include "trial/observe/announcer.hpp"
#include "trial/scenario/config_folder.hpp"

namespace vantage::tools {
namespace {

struct LocalizeArguments {
  std::string source;
  std::string parameters;  ///< scenario file; empty: parameters of the log
  std::string start = "known";
  double loss = 0.0;
  std::uint64_t seed = 1;
  double late_s = 0.0;
  bool is_smoothed = false;
  std::string landmarks = "known";
  bool is_without_ids = false;
  std::vector<std::string> heading;  ///< robots with a trusted true heading; empty: all
  std::string log;                   ///< log to write; empty: none
  std::string table;                 ///< CSV file to write; empty: none
  bool force = false;
  bool as_json = false;
};

struct TimedPose {
  std::size_t robot = 0;
  Time time{};
  Pose2 world_from_body;
  Eigen::Matrix3d covariance;
};

std::vector<std::string> names_of(const TeamRecording& team) {
  std::vector<std::string> names;
  for (const scenario::LocalizedRobotSpec& robot : team.spec.robots) {
    names.push_back(robot.name);
  }
  return names;
}

/// Returns for each robot whether its true heading is trusted as a reference.
std::vector<bool> trusted_of(const LocalizeArguments& arguments, const TeamRecording& team) {
  const std::vector<std::string> names = names_of(team);
  for (const std::string& name : arguments.heading) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw StartupError(team.source + ": has no robot '" + name + "'; --heading needs names of " +
                         "robots in the section localizer");
    }
  }
  std::vector<bool> trusted;
  for (const std::string& name : names) {
    trusted.push_back(arguments.heading.empty() ||
                      std::find(arguments.heading.begin(), arguments.heading.end(), name) !=
                          arguments.heading.end());
  }
  return trusted;
}

template <class Message>
void write_event(const bus::Channel<Message>& channel, const Message& message, std::int64_t number,
                 OutputLog& log) {
  const auto wire = bus::to_wire(message);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  log.sink()({number, message.stamp.time, channel.name, bytes});
}

/// Writes the poses as POSE_R, after SCENARIO. Returns an error, or "".
std::string write_log(const std::vector<TimedPose>& poses, const TeamRecording& team,
                      OutputLog& log) {
  if (poses.empty()) {
    return log.finish();
  }
  models::ScenarioNotice notice;
  notice.stamp.time = poses.front().time;
  notice.stamp.run_id = to_utime(notice.stamp.time);
  notice.yaml = team.yaml;
  notice.version = trial::version();
  notice.process = "localize";
  std::int64_t number = 0;
  write_event(bus::kScenario, notice, number++, log);
  std::vector<std::int64_t> sequences(team.spec.robots.size(), 0);
  for (const TimedPose& each : poses) {
    models::PoseEstimate estimate;
    estimate.stamp = {each.time, notice.stamp.run_id, sequences[each.robot]++};
    estimate.robot = team.spec.robots[each.robot].name;
    estimate.source = models::PoseSource::kLocalizer;
    estimate.world_from_body = each.world_from_body;
    estimate.covariance = each.covariance;
    estimate.increments_from = each.time;
    estimate.increment = localizer::kIncrement;
    write_event(bus::pose_channel(estimate.robot), estimate, number++, log);
  }
  return log.finish();
}

std::string csv_of(const std::vector<TimedPose>& poses, const TeamRecording& team) {
  std::string text =
      "utime,robot,x_m,y_m,yaw_rad,sigma_x_m,sigma_y_m,sigma_yaw_rad,true_x_m,true_y_m,"
      "true_yaw_rad\n";
  for (const TimedPose& each : poses) {
    const Pose2& pose = each.world_from_body;
    const Eigen::Vector3d sigma = each.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    text += fmt::format("{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f}", to_utime(each.time),
                        team.spec.robots[each.robot].name, pose.x_m, pose.y_m, pose.yaw_rad,
                        sigma.x(), sigma.y(), sigma.z());
    const auto truth = team.recording[each.robot].truth.at(each.time);
    text += truth ? fmt::format(",{:.5f},{:.5f},{:.5f}\n", truth->x_m, truth->y_m, truth->yaw_rad)
                  : std::string(",,,\n");
  }
  return text;
}

/// Returns the names of the robots whose position is more than 0.3 m worse than in the reference
/// run for more than 10 s. Both lists are sorted by time.
std::vector<std::string> lost_robots(const std::vector<TimedPose>& reference,
                                     const std::vector<TimedPose>& poses,
                                     const TeamRecording& team) {
  constexpr double kWorseM = 0.3;
  constexpr double kLostS = 10.0;
  std::vector<std::string> lost;
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    std::map<Time, Eigen::Vector2d> before;
    for (const TimedPose& each : reference) {
      if (each.robot == robot) {
        before[each.time] = each.world_from_body.position_m();
      }
    }
    std::optional<Time> since;
    bool is_lost = false;
    for (const TimedPose& each : poses) {
      const auto truth = team.recording[robot].truth.at(each.time);
      const auto other = before.find(each.time);
      if (each.robot != robot || !truth || other == before.end()) {
        continue;
      }
      const Eigen::Vector2d true_m = truth->position_m();
      const bool is_worse = (each.world_from_body.position_m() - true_m).norm() >
                            (other->second - true_m).norm() + kWorseM;
      since = !is_worse ? std::nullopt : since ? since : std::optional(each.time);
      is_lost = is_lost || (since && to_seconds(each.time - *since) > kLostS);
    }
    if (is_lost) {
      lost.push_back(team.spec.robots[robot].name);
    }
  }
  return lost;
}

/// Result of one run of the localisers.
struct Run {
  localizer::JudgeFigures figures;
  std::vector<TimedPose> poses;  ///< sorted by time, then by robot
};

Run run_of(const TeamRecording& team, localizer::JudgeOptions options,
           const std::vector<bool>& trusted) {
  Run run;
  options.watch = [&](std::size_t robot, Time time, const Pose2& pose,
                      const Eigen::Matrix3d& covariance) {
    run.poses.push_back({robot, time, pose, covariance});
  };
  run.figures = localizer::judge(team.spec, team.recording, options, trusted);
  std::stable_sort(run.poses.begin(), run.poses.end(), [](const TimedPose& a, const TimedPose& b) {
    return a.time != b.time ? a.time < b.time : a.robot < b.robot;
  });
  return run;
}

/// Prints the figures, and the lost robots unless `lost` is absent.
void print(const LocalizeArguments& arguments, const TeamRecording& team, const Run& run,
           const std::optional<std::vector<std::string>>& lost) {
  if (arguments.as_json) {
    nlohmann::ordered_json json = to_json(run.figures, names_of(team));
    if (lost) {
      json["lost_robots"] = *lost;
    }
    print_json(json);
    return;
  }
  for (const std::string& line : to_lines(run.figures, names_of(team))) {
    print_line(line);
  }
  if (lost) {
    print_line(fmt::format("lost robots: {}", lost->empty()
                                                  ? std::string("none")
                                                  : fmt::format("{}", fmt::join(*lost, ", "))));
  }
}

/// Removes the ids of all sightings.
void remove_ids(TeamRecording& team) {
  for (localizer::RobotRecording& robot : team.recording) {
    for (localizer::SightingFrame& frame : robot.frames) {
      for (models::Sighting& sighting : frame.sightings) {
        sighting.id = localizer::kNoBodyId;
      }
    }
  }
}

void check_options(const LocalizeArguments& arguments) {
  if (arguments.is_smoothed && arguments.late_s > 0.0) {
    throw StartupError("--smoothed and --late-s exclude each other: --smoothed uses all data");
  }
  if ((arguments.is_smoothed || arguments.late_s > 0.0) && arguments.loss > 0.0) {
    throw StartupError(
        "--loss needs robots that exchange messages; --late-s and --smoothed use "
        "one filter for all robots");
  }
  if (arguments.start == "unknown" && arguments.landmarks == "unknown") {
    throw StartupError(
        "--landmarks unknown needs --start known: a robot finds its start by "
        "landmarks at known positions");
  }
  if (arguments.is_without_ids &&
      (arguments.start == "unknown" || arguments.landmarks == "unknown")) {
    throw StartupError(
        "--without-ids needs --start known and --landmarks known: without ids, "
        "robots find neither their start nor new landmarks");
  }
}

/// Returns the options of the run. Hides the landmarks of `team` if they shall be unknown.
localizer::JudgeOptions options_of(const LocalizeArguments& arguments, TeamRecording& team) {
  localizer::JudgeOptions options;
  options.is_start_known = arguments.start == "known";
  options.loss = arguments.loss;
  options.seed = arguments.seed;
  options.hindsight_s =
      arguments.is_smoothed ? std::numeric_limits<double>::infinity() : arguments.late_s;
  if (arguments.landmarks == "unknown") {
    options.hidden_landmarks = std::move(team.spec.landmarks);
    team.spec.landmarks.clear();
    team.spec.unknown_landmarks_max = static_cast<int>(options.hidden_landmarks.size());
  }
  return options;
}

int localize(const LocalizeArguments& arguments) {
  check_options(arguments);
  if (!arguments.table.empty()) {
    require_writable(arguments.table);
  }
  const DefaultSignalScope working;
  TeamRecording team = read_team(arguments.source);
  require_truth(team);
  if (!arguments.parameters.empty()) {
    use_parameters(trial::scenario_path(arguments.parameters), team);
  }
  const std::vector<bool> trusted = trusted_of(arguments, team);
  std::optional<OutputLog> log;
  if (!arguments.log.empty()) {
    log.emplace(arguments.log, std::vector{arguments.source}, arguments.force);
  }
  const localizer::JudgeOptions options = options_of(arguments, team);
  std::optional<Run> reference;
  if (arguments.is_without_ids) {
    reference = run_of(team, options, trusted);
    remove_ids(team);
  }
  const Run run = run_of(team, options, trusted);
  print(arguments, team, run,
        reference ? std::optional(lost_robots(reference->poses, run.poses, team)) : std::nullopt);
  if (log) {
    if (const std::string failure = write_log(run.poses, team, *log); !failure.empty()) {
      print_line("vantage: " + failure, stderr);
      return 1;
    }
  }
  if (!arguments.table.empty()) {
    write_file(arguments.table, csv_of(run.poses, team));
  }
  return 0;
}

void add_protocol_options(CLI::App& command, LocalizeArguments& arguments) {
  command
      .add_option("--start", arguments.start,
                  "known: each robot knows the true start, sigma 0.01 m and 0.01 rad; unknown: "
                  "the first 60 s are not evaluated")
      ->check(one_of({"known", "unknown"}))
      ->capture_default_str();
  command
      .add_option("--loss", arguments.loss,
                  "probability that a robot misses a message of a teammate, 0 to 1")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--seed", arguments.seed, "seed of the lost messages")
      ->check(seed_number())
      ->capture_default_str();
  command
      .add_option("--late-s", arguments.late_s,
                  "also use the data of this number of seconds after each estimate's time, in one "
                  "filter for all robots; 0: none")
      ->check(number_between(0.0, 3600.0))
      ->capture_default_str();
  command.add_flag("--smoothed", arguments.is_smoothed,
                   "use all data for each estimate, in one filter for all robots");
  command
      .add_option("--landmarks", arguments.landmarks,
                  "known: at the positions of the log; unknown: the filters map them, and the "
                  "estimates are compared with the truth after one rotation and translation")
      ->check(one_of({"known", "unknown"}))
      ->capture_default_str();
  command.add_flag("--without-ids", arguments.is_without_ids,
                   "remove the ids of all sightings, and report robots that get lost: more than "
                   "0.3 m worse than with ids for more than 10 s");
  command.add_option(
      "--heading", arguments.heading,
      "robots whose true heading is accurate enough to evaluate; default: all robots");
}

}  // namespace

void add_log_localize_command(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<LocalizeArguments>();
  CLI::App* command = log.add_subcommand(
      "localize", "Run the localisers of all robots on a recording and compare with the truth.");
  command
      ->add_option("log", arguments->source,
                   "LCM event log with SCENARIO, ODOMETRY_R, SIGHTINGS_R and VICON or TRUTH; or a "
                   "folder of the MRCLAM data set")
      ->required();
  command->add_option("--scenario", arguments->parameters,
                      "scenario with the parameters of sensors, drives and noise (section "
                      "localizer); default: those of the log");
  add_protocol_options(*command, *arguments);
  command->add_option("--out", arguments->log, "log to write, with the estimates as POSE_R");
  command->add_option("--csv", arguments->table,
                      "table (CSV) to write, with one row per robot and instant");
  command->add_flag("--force", arguments->force, "overwrite the log of --out if it exists");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Each robot's localiser uses its own data and the messages of its teammates, 5 times per\n"
      "second. Estimates are evaluated every 0.1 s; an estimate uses only data stamped until its\n"
      "time. NEES is the squared error divided by the estimated variance.\n"
      "Examples:\n"
      "  vantage log localize six.lcmlog --scenario mrclam --heading R2 R3 R4 R5\n"
      "  vantage log localize MRCLAM_Dataset6 --scenario mrclam --start unknown --loss 0.2\n"
      "  vantage log localize six.lcmlog --scenario mrclam --smoothed --csv poses.csv");
  command->callback(
      [&chosen, arguments] { chosen = [arguments] { return localize(*arguments); }; });
}

}  // namespace vantage::tools
