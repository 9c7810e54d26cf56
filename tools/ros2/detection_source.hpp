#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sensor/frame_history.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "tools/ros2/incoming.hpp"

namespace vantage::tools::ros2 {

struct DetectionCounts {
  std::int64_t unreadable = 0;      ///< messages that are damaged or contain impossible numbers
  std::int64_t wrong_frame = 0;     ///< messages in a frame other than world and robot
  std::int64_t stale = 0;           ///< messages with a stamp older than kAgeMax
  std::int64_t early = 0;           ///< messages with a stamp in the future: the clocks differ
  std::int64_t without_pose = 0;    ///< messages for whose time the robot's pose is unknown
  std::int64_t overflowed = 0;      ///< old messages dropped to make room for newer ones
  std::int64_t unknown_target = 0;  ///< objects that name no target of the scenario
  std::int64_t out_of_view = 0;     ///< objects that the robot's sensor cannot have seen
};

/// Source of MEASUREMENT_R from the detections of one robot on a ROS 2 topic, without sockets.
///
/// An object's position, in the frame of the world or of the robot, becomes a measurement of the
/// robot's sensor: z = h(position), with the covariance H Σ Hᵀ. If no covariance is stated, that of
/// the sensor is used. The robot's pose at the stamp is interpolated between mocap frames, so a
/// message waits until a later frame has arrived.
class DetectionSource {
 public:
  static constexpr Duration kAgeMax{1'000'000};
  static constexpr Duration kEarlyMax{5'000};

  /// Precondition: `robot` is in the scenario.
  DetectionSource(const scenario::Scenario& scenario, const std::string& robot,
                  std::string world_frame);

  void on_frame(std::shared_ptr<const models::MocapFrame> frame);
  void on_message(Bytes cdr, Time now);
  /// Returns the next measurement whose time lies before a received frame.
  std::optional<models::RobotMeasurement> next(Time now);

  [[nodiscard]] const std::string& robot() const { return robot_; }
  [[nodiscard]] const DetectionCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kWaitingMax = 16;

  std::optional<models::RobotMeasurement> measurement(const SeenObjects& seen);
  void add(const SeenObject& object, bool is_world, const Pose3& world_from_body,
           models::RobotMeasurement& out);
  [[nodiscard]] std::optional<int> target_of(const SeenObject& object) const;

  std::string robot_;
  std::string world_frame_;
  models::SensorModel sensor_;
  bool detects_ids_;
  int position_dim_;
  std::vector<scenario::TargetSpec> targets_;
  drivers::FrameHistory frames_{kAgeMax};
  std::deque<SeenObjects> waiting_;
  DetectionCounts counts_;
};

}  // namespace vantage::tools::ros2
