#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/time.hpp"
#include "drivers/sensor/jam_watch.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "drivers/sensor/range_scanner.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/mocap_clock.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Bus node of vantage-sensor for one robot: subscribes to VICON and ATTACK, publishes
/// MEASUREMENT_R and, in a scenario with mapping, SCAN_R.
///
/// Measurements refer to the instants kτ since the epoch, with integer k and τ = planner.step_s.
/// When the first frame captured at or after kτ arrives, the bodies are interpolated between this
/// frame and the previous one. A frame captured exactly at kτ is used without interpolation. A
/// sensor that measures velocities compares with the newest frame at least 0.1 s older than kτ.
///
/// With localizer.simulation the sensor measures the true bodies (TRUTH) instead, and its viewpoint
/// is POSE_R at kτ. The covariance of the pose is added to the covariance of each measurement.
class SensorNode : public bus::Node {
 public:
  /// Function that computes the measurement from a frame, like PoseSensor::measure().
  using MeasureFunction = std::function<std::optional<models::RobotMeasurement>(
      const models::MocapFrame& frame, bool jammed)>;

  /// @param measure  replaces the scenario's sensor; empty: PoseSensor
  /// @throws UsageError for a robot that is not in the scenario or a step that is not positive.
  SensorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
             const std::string& robot, MeasureFunction measure = {});

  [[nodiscard]] std::string name() const override { return "SENSOR_" + robot_; }
  /// All work is done when frames arrive; the tick does nothing.
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  void on_frame(const std::shared_ptr<const models::MocapFrame>& received);
  void on_truth(const models::TruthFrame& truth);
  void on_pose(const models::PoseEstimate& estimate);
  /// Publishes the measurement at the instant of `frame`. `assumed`: the pose from which the robot
  /// assumes to measure; null: its pose in `frame`.
  void publish(const models::MocapFrame& frame, std::vector<models::InputRef> inputs,
               const models::PoseEstimate* assumed = nullptr);
  /// Appends the frame to recent_ and removes the frames that no later instant needs.
  void keep(const std::shared_ptr<const models::MocapFrame>& frame);
  /// Returns the newest kept frame at least kVelocityBase before `time`, but not older than
  /// kVelocityBaseMax; null if there is none.
  [[nodiscard]] const models::MocapFrame* earlier_frame(Time time) const;

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string robot_;
  MeasureFunction measure_;
  std::optional<RangeScanner> scanner_;  ///< only in a scenario with mapping
  models::SensorModel sensor_;
  int position_dim_;
  std::deque<std::shared_ptr<const models::MocapFrame>> truth_;  ///< true bodies, newest last
  Duration step_;
  Time next_tick_;
  models::MocapClock mocap_clock_;
  std::shared_ptr<const models::MocapFrame> last_;
  bool keeps_recent_ = false;  ///< true: the sensor measures velocities
  std::deque<std::shared_ptr<const models::MocapFrame>> recent_;
  JamWatch jam_watch_;
  std::int64_t steps_without_frames_ = 0;
  std::int64_t steps_without_own_pose_ = 0;
  std::int64_t frames_out_of_order_ = 0;
  std::int64_t mocap_restarts_ = 0;
  std::int64_t misaddressed_ = 0;
};

}  // namespace vantage::drivers
