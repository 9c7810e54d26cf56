#include "localizer/fit/sighted_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "localizer/commanded_motion.hpp"
#include "localizer/fit/robust_fit.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

constexpr std::size_t kPairsMin = 100;
constexpr double kSightedTurnSigmaRad = 0.01;  // 1σ of a turn between two frames
constexpr double kApartMaxS = 0.6;

/// A landmark in two frames.
struct Common {
  Eigen::Vector2d first_m = Eigen::Vector2d::Zero();  ///< in the body frame
  Eigen::Vector2d second_m = Eigen::Vector2d::Zero();
};

/// Two frames with common landmarks.
struct Pair {
  std::size_t first = 0;
  std::size_t second = 0;
  std::vector<Common> landmarks;
};

/// Returns pairs of consecutive frames with a common landmark.
std::vector<Pair> pairs_of(const std::vector<scenario::LandmarkSpec>& landmarks,
                           const scenario::SightingSpec& sensor, const RobotRecording& recording) {
  std::vector<Pair> pairs;
  const auto point_of = [&](const models::Sighting& sighting) {
    return sighted_point_m(sensor, sighting.range_m, sighting.bearing_rad);
  };
  const auto& frames = recording.frames;
  for (std::size_t j = 1; j < frames.size(); ++j) {
    const std::size_t i = j - 1;
    if (to_seconds(frames[j].stamp - frames[i].stamp) > kApartMaxS) {
      continue;
    }
    Pair pair{i, j, {}};
    for (const models::Sighting& a : frames[i].sightings) {
      const auto has_id = [&](const auto& each) { return each.id == a.id; };
      const auto b = std::find_if(frames[j].sightings.begin(), frames[j].sightings.end(), has_id);
      if (b != frames[j].sightings.end() &&
          std::any_of(landmarks.begin(), landmarks.end(), has_id)) {
        pair.landmarks.push_back({point_of(a), point_of(*b)});
      }
    }
    if (!pair.landmarks.empty()) {
      pairs.push_back(pair);
    }
  }
  return pairs;
}

/// Poses of the commanded motion at the frames.
std::vector<Pose2> commanded_poses(const RobotRecording& recording, double stamp_delay_s,
                                   const Response& response) {
  CommandedMotion motion({.delay_s = response.delay_s, .lag_s = response.lag_s});
  std::vector<Pose2> poses;
  Pose2 pose;
  std::size_t next = 0;
  for (const SightingFrame& frame : recording.frames) {
    const Time time = frame.stamp - from_seconds(stamp_delay_s);
    for (; next < recording.odometry.size() && recording.odometry[next].stamp.time <= time;
         ++next) {
      const models::OdometryReport& each = recording.odometry[next];
      const Eigen::Vector3d moved = motion.advance_to(each.stamp.time);
      pose = pose * Pose2{moved.x(), moved.y(), moved.z()};
      motion.command(each.stamp.time, each.motion_body.x(), each.motion_body.z());
    }
    const Eigen::Vector3d moved = motion.advance_to(time);
    pose = pose * Pose2{moved.x(), moved.y(), moved.z()};
    poses.push_back(pose);
  }
  return poses;
}

/// Sighted and commanded turns of pairs of frames.
struct Turns {
  std::vector<double> sighted_rad;
  std::vector<double> commanded_rad;
};

Turns turns_of(const std::vector<Pair>& pairs, const std::vector<Pose2>& commanded) {
  Turns out;
  for (const Pair& pair : pairs) {
    const Pose2 moved = inverse(commanded[pair.first]) * commanded[pair.second];
    double turn_rad = 0.0;  // mean over the common landmarks of the pair
    for (const Common& each : pair.landmarks) {
      const Eigen::Vector2d from = each.first_m - moved.position_m();
      turn_rad += wrap_to_pi(std::atan2(from.y(), from.x()) -
                             std::atan2(each.second_m.y(), each.second_m.x())) /
                  static_cast<double>(pair.landmarks.size());
    }
    out.sighted_rad.push_back(turn_rad);
    out.commanded_rad.push_back(moved.yaw_rad);
  }
  return out;
}

}  // namespace

Response sighted_response(const std::vector<scenario::LandmarkSpec>& landmarks,
                          const scenario::SightingSpec& sensor, const RobotRecording& recording) {
  const std::vector<Pair> pairs = pairs_of(landmarks, sensor, recording);
  require(pairs.size() >= kPairsMin,
          "at least 100 pairs of frames with a common landmark are needed; the log has " +
              std::to_string(pairs.size()));
  return least_loss_response([&](double delay_s, double lag_s) {
    const Turns turns =
        turns_of(pairs, commanded_poses(recording, sensor.stamp_delay_s, {delay_s, lag_s}));
    double scale = 1.0;
    double offset = 0.0;
    return robust_line(turns.commanded_rad, turns.sighted_rad, kSightedTurnSigmaRad, true, scale,
                       offset);
  });
}

}  // namespace vantage::localizer
