#pragma once

#include <optional>
#include <vector>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// True poses of one robot, ascending in time.
class TruePath {
 public:
  /// Adds a pose. A pose that is not newer than the last one is ignored.
  void add(Time time, const Pose2& world_from_body);
  /// Returns the pose at `time`, interpolated linearly between samples that are less than 0.2 s
  /// apart; nullopt elsewhere.
  [[nodiscard]] std::optional<Pose2> at(Time time) const;
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] Time begin() const { return times_.front(); }
  [[nodiscard]] Time end() const { return times_.back(); }

 private:
  std::vector<Time> times_;
  std::vector<Pose2> poses_;
};

/// Sightings of one frame of a sensor.
struct SightingFrame {
  /// time as reported; `sightings` contain the same time, not yet corrected for the latency
  Time stamp{};
  std::vector<models::Sighting> sightings;
};

/// Inputs and true poses of one robot, ascending in time.
struct RobotRecording {
  std::vector<models::OdometryReport> odometry;
  std::vector<SightingFrame> frames;
  TruePath truth;
};

/// Inputs and true poses of a team; robots in the order of LocalizerSpec::robots.
using Recording = std::vector<RobotRecording>;

}  // namespace vantage::localizer
