#include "tools/log/team_recording.hpp"

#include <algorithm>
#include <filesystem>
#include <type_traits>

#include "core/check.hpp"
#include "logs/file/message_visit.hpp"
#include "logs/mrclam/mrclam_log.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "tools/log/log_scenario.hpp"

namespace vantage::tools {
namespace {

/// Collects the messages of a log.
class Collector {
 public:
  Collector(TeamRecording& team, bool has_truth) : team_(team), has_truth_(has_truth) {}

  template <class Message>
  void on(const Message& message) {
    if constexpr (std::is_same_v<Message, models::OdometryReport>) {
      if (localizer::RobotRecording* robot = find(message.robot)) {
        robot->odometry.push_back(message);
      }
    } else if constexpr (std::is_same_v<Message, models::SightingReport>) {
      localizer::RobotRecording* robot = find(message.robot);
      if (robot != nullptr && !message.sightings.empty()) {
        robot->frames.push_back({message.stamp.time, message.sightings});
      }
    } else if constexpr (std::is_same_v<Message, models::MocapFrame>) {
      for (const models::MocapBody& body : message.bodies) {
        if (!has_truth_ && !body.occluded) {
          add_truth(body.name, message.stamp.time, body.world_from_body);
        }
      }
    } else if constexpr (std::is_same_v<Message, models::TruthFrame>) {
      for (const models::TruthBody& body : message.bodies) {
        add_truth(body.name, message.stamp.time, body.world_from_body);
      }
    }
  }

 private:
  localizer::RobotRecording* find(const std::string& name) {
    const auto& robots = team_.spec.robots;
    const auto found =
        std::find_if(robots.begin(), robots.end(),
                     [&](const scenario::LocalizedRobotSpec& each) { return each.name == name; });
    return found == robots.end()
               ? nullptr
               : &team_.recording[static_cast<std::size_t>(found - robots.begin())];
  }
  void add_truth(const std::string& name, Time time, const Pose3& world_from_body) {
    if (localizer::RobotRecording* robot = find(name)) {
      robot->truth.add(time, flatten(world_from_body));
    }
  }

  TeamRecording& team_;
  bool has_truth_;
};

}  // namespace

TeamRecording team_of(const logs::MrclamData& data, const std::string& source) {
  TeamRecording team;
  team.source = source;
  team.yaml = logs::mrclam_scenario(data);
  for (const auto& landmark : data.landmarks) {
    team.spec.landmarks.push_back({landmark.subject, landmark.position_m});
  }
  for (const auto& robot : data.robots) {
    scenario::LocalizedRobotSpec& one = team.spec.robots.emplace_back();
    one.name = logs::mrclam_robot(robot.subject);
    one.id = robot.subject;
    localizer::RobotRecording& inputs = team.recording.emplace_back();
    for (const auto& command : robot.commands) {
      models::OdometryReport& odometry = inputs.odometry.emplace_back();
      odometry.kind = models::OdometryKind::kCommand;
      odometry.stamp.time = command.time;
      odometry.robot = one.name;
      odometry.motion_body = {command.speed_mps, 0.0, command.turn_radps};
    }
    for (const auto& each : robot.observations) {
      if (inputs.frames.empty() || inputs.frames.back().stamp != each.time) {
        inputs.frames.push_back({each.time, {}});
      }
      inputs.frames.back().sightings.push_back(
          {each.time, each.subject, each.range_m, each.bearing_rad});
    }
    for (const auto& pose : robot.truth) {
      inputs.truth.add(pose.time, pose.world_from_body);
    }
  }
  return team;
}

TeamRecording team_of(const logs::IndexedLog& log) {
  TeamRecording team;
  team.source = log.path();
  team.yaml = scenario_of(log).source_text;
  auto spec = scenario::parse_localizer(team.yaml, log.path() + " (SCENARIO)");
  if (!spec) {
    throw StartupError(log.path() +
                       ": the scenario has no section localizer; this command needs the landmarks "
                       "and the ids of the robots");
  }
  team.spec = std::move(*spec);
  team.recording.resize(team.spec.robots.size());
  Collector collector(team, log.survey().channels.contains("TRUTH"));
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    logs::visit_message(*event, [&](const auto& message) { collector.on(message); });
  }
  return team;
}

TeamRecording read_team(const std::string& path) {
  std::error_code error;
  TeamRecording team = std::filesystem::is_directory(path, error)
                           ? team_of(logs::read_mrclam(path), path)
                           : team_of(logs::IndexedLog(path));
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    if (team.recording[robot].odometry.empty()) {
      throw StartupError(path + ": contains no odometry of robot " + team.spec.robots[robot].name +
                         "; the log must contain ODOMETRY_" + team.spec.robots[robot].name);
    }
  }
  return team;
}

void require_truth(const TeamRecording& team) {
  for (std::size_t robot = 0; robot < team.recording.size(); ++robot) {
    if (team.recording[robot].truth.empty()) {
      throw StartupError(team.source + ": contains no true pose of robot " +
                         team.spec.robots[robot].name + "; the log must contain VICON or TRUTH");
    }
  }
}

void use_parameters(const std::string& path, TeamRecording& team) {
  const auto fitted = scenario::parse_localizer(scenario::read_text_file(path), path);
  if (!fitted) {
    throw StartupError(path + ": has no section localizer; vantage log fit-sensor prints one");
  }
  for (scenario::LocalizedRobotSpec& robot : team.spec.robots) {
    const auto found = std::find_if(
        fitted->robots.begin(), fitted->robots.end(),
        [&](const scenario::LocalizedRobotSpec& each) { return each.name == robot.name; });
    if (found == fitted->robots.end()) {
      throw StartupError(path + ": localizer.robots does not contain robot " + robot.name +
                         " of the recording");
    }
    robot.sightings = found->sightings;
    robot.drive = found->drive;
  }
  team.spec.odometry_noise = fitted->odometry_noise;
  team.spec.sighting_noise = fitted->sighting_noise;
}

}  // namespace vantage::tools
