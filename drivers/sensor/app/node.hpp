#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/time.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "drivers/sensor/range_scanner.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/mocap_clock.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// vantage-sensor of one robot on the bus: VICON and ATTACK in, MEASUREMENT_R out and, in a
/// scenario that maps, SCAN_R.
///
/// A measurement is of the instants kτ, k whole, τ = planner.step_s, counted from the epoch: as
/// soon as the first frame captured at or after kτ is there, the bodies are put between it and the
/// frame before. A frame captured at kτ itself is used alone.
class SensorNode : public bus::Node {
 public:
  /// What is seen in a frame, as PoseSensor::look().
  using Look = std::function<std::optional<models::DetectionSet>(const models::MocapFrame& frame,
                                                                 bool jammed)>;

  /// @param look  another sensor than the scenario's; empty: PoseSensor
  /// @throws UsageError for a robot that is not in the scenario or a step that is not positive.
  SensorNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
             const std::string& robot, Look look = {});

  [[nodiscard]] std::string name() const override { return "SENSOR_" + robot_; }
  /// It works when frames arrive; the tick has nothing to do.
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  void on_frame(const std::shared_ptr<const models::MocapFrame>& received);
  /// Whether this robot is, by the newest notice that still holds.
  [[nodiscard]] bool is_jammed();
  void publish(const models::MocapFrame& frame, std::vector<models::InputRef> inputs);

  bus::Bus& bus_;
  const bus::Clock& clock_;
  std::string robot_;
  Look look_;
  std::optional<RangeScanner> scanner_;  ///< of a scenario that maps
  Duration step_;
  Time next_tick_;
  models::MocapClock mocap_clock_;
  std::shared_ptr<const models::MocapFrame> last_;
  std::optional<models::AttackNotice> attack_;
  Time attack_heard_{};
  std::int64_t steps_without_frames_ = 0;
  std::int64_t steps_without_own_pose_ = 0;
  std::int64_t frames_out_of_order_ = 0;
  std::int64_t mocap_restarts_ = 0;
};

}  // namespace vantage::drivers
