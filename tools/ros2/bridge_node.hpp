#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "core/latency_record.hpp"
#include "core/time.hpp"
#include "logs/export/ros2_messages.hpp"
#include "scenario/ros2_spec.hpp"
#include "scenario/scenario.hpp"
#include "tools/ros2/detection_source.hpp"
#include "tools/ros2/port.hpp"
#include "tools/ros2/pose_source.hpp"

namespace vantage::tools::ros2 {

/// Bus node of `vantage ros2`: publishes the messages of the bus on ROS 2 topics, and publishes
/// VICON and MEASUREMENT_R from ROS 2 topics (docs/guide/ros2.md).
class BridgeNode : public bus::Node {
 public:
  /// `bus`, `clock` and `port` must outlive the node.
  BridgeNode(bus::Bus& bus, const bus::Clock& clock, Port& port, const scenario::Scenario& scenario,
             const scenario::Ros2Spec& spec);

  [[nodiscard]] std::string name() const override { return "ROS2"; }
  [[nodiscard]] Time next_tick() const override { return next_tick_; }
  void tick(Time now) override;
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;

 private:
  void read_topics();
  void write_channels();
  /// Publishes every message of `channel` on ROS 2.
  template <class Message>
  void write_channel(const bus::Channel<Message>& channel);
  void write(const logs::ros2::Message& message);
  [[nodiscard]] std::string topic_of(const logs::ros2::Message& message) const;
  [[nodiscard]] drivers::vicon::Moment moment() const;

  bus::Bus& bus_;
  const bus::Clock& clock_;
  Port& port_;
  scenario::Ros2Spec spec_;
  std::vector<std::string> robots_;
  std::optional<PoseSource> poses_;
  std::vector<std::unique_ptr<DetectionSource>> detections_;
  Duration period_;
  Time next_tick_;
  LatencyRecord latency_;     ///< time to convert and write a message of the bus
  std::int64_t refused_ = 0;  ///< messages that DDS did not accept
};

}  // namespace vantage::tools::ros2
