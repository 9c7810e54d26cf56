#pragma once

#include <string>

#include "localizer/judge/recording.hpp"
#include "logs/mrclam/mrclam.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::test {

/// The data set in a folder, as inputs of the localisers.
struct MrclamTrial {
  explicit MrclamTrial(const std::string& folder) {
    const logs::MrclamData data = logs::read_mrclam(folder);
    for (const auto& landmark : data.landmarks) {
      spec.landmarks.push_back({landmark.subject, landmark.position_m});
    }
    for (const auto& robot : data.robots) {
      scenario::LocalizedRobotSpec& one = spec.robots.emplace_back();
      one.name = "R" + std::to_string(robot.subject);
      one.id = robot.subject;
      localizer::RobotRecording& inputs = recording.emplace_back();
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
  }
  scenario::LocalizerSpec spec;
  localizer::Recording recording;
};

}  // namespace vantage::test
