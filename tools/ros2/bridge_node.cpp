#include "tools/ros2/bridge_node.hpp"

#include <type_traits>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/deadline.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::tools::ros2 {
namespace {

constexpr Duration kPollPeriod{1'000};  // delays messages from ROS 2 by at most this time
constexpr Duration kIdlePeriod{50'000};

}  // namespace

BridgeNode::BridgeNode(bus::Bus& bus, const bus::Clock& clock, Port& port,
                       const scenario::Scenario& scenario, const scenario::Ros2Spec& spec)
    : bus_(bus),
      clock_(clock),
      port_(port),
      spec_(spec),
      period_(spec.poses.empty() && spec.detections.empty() ? kIdlePeriod : kPollPeriod),
      next_tick_(clock.now()) {
  for (const scenario::RobotSpec& robot : scenario.robots) {
    robots_.push_back(robot.name);
  }
  if (!spec.poses.empty()) {
    poses_.emplace(scenario, spec.world_frame,
                   [this](const models::MocapFrame& frame) { bus_.publish(bus::kVicon, frame); });
  }
  for (const scenario::Ros2DetectionInput& input : spec.detections) {
    detections_.push_back(
        std::make_unique<DetectionSource>(scenario, input.robot, spec.world_frame));
  }
  read_topics();
  write_channels();
}

void BridgeNode::read_topics() {
  for (const scenario::Ros2PoseInput& input : spec_.poses) {
    port_.read(input.topic, type_of(input.type),
               [this, input](Bytes cdr) { poses_->on_message(input, cdr, moment()); });
  }
  for (std::size_t i = 0; i < detections_.size(); ++i) {
    port_.read(spec_.detections[i].topic, kDetectionsType,
               [this, source = detections_[i].get()](Bytes cdr) {
                 source->on_message(cdr, clock_.now());
               });
  }
}

void BridgeNode::write_channels() {
  bus_.subscribe_shared<models::MocapFrame>(bus::kVicon,
                                            [this](const std::string& /*name*/, const auto& frame) {
                                              for (const auto& source : detections_) {
                                                source->on_frame(frame);
                                              }
                                            });
  write_channel(bus::kVicon);
  write_channel(bus::kTruth);
  for (const std::string& robot : robots_) {
    write_channel(bus::plan_channel(robot));
    write_channel(bus::belief_channel(robot));
    write_channel(bus::map_channel(robot));
    write_channel(bus::scan_channel(robot));
    write_channel(bus::vehicle_channel(robot));
  }
  write_channel(bus::health_channel("*"));
}

template <class Message>
void BridgeNode::write_channel(const bus::Channel<Message>& channel) {
  bus_.subscribe<Message>(channel, [this](const Message& message) {
    const std::int64_t begin_ns = monotonic_ns();
    for (const logs::ros2::Message& each : logs::ros2::to_ros2(message, spec_.world_frame)) {
      write(each);
    }
    if constexpr (std::is_same_v<Message, models::RobotBelief>) {
      write(logs::ros2::markers_of(message, spec_.world_frame));
    }
    if constexpr (std::is_same_v<Message, models::MocapFrame>) {
      for (const auto& each : logs::ros2::poses_of(message, robots_, spec_.world_frame)) {
        write(each);
      }
    }
    latency_.add(Duration{(monotonic_ns() - begin_ns) / 1'000});
  });
}

void BridgeNode::write(const logs::ros2::Message& message) {
  const bool is_map = message.type == "nav_msgs/msg/OccupancyGrid";
  const bool is_written =
      port_.write(topic_of(message), message.type,
                  is_map ? Durability::kTransient : Durability::kVolatile, message.cdr);
  refused_ += is_written ? 0 : 1;
}

// Topics that all ROS 2 nodes share, such as /tf, get no prefix.
std::string BridgeNode::topic_of(const logs::ros2::Message& message) const {
  const bool is_common = message.topic == "/tf" || message.topic == "/diagnostics";
  return is_common ? message.topic : spec_.prefix + message.topic;
}

drivers::vicon::Moment BridgeNode::moment() const {
  return {clock_.now(), Duration{monotonic_ns() / 1'000}};
}

void BridgeNode::tick(Time now) {
  port_.take();
  if (poses_) {
    poses_->on_time(moment());
  }
  for (const auto& source : detections_) {
    while (auto made = source->next(clock_.now())) {
      bus_.publish(bus::measurement_channel(source->robot()), std::move(*made));
    }
  }
  next_tick_ = now + period_;
}

std::vector<models::NamedCount> BridgeNode::counters() const {
  std::vector<models::NamedCount> out = models::nonzero({{"ros2.messages_refused", refused_}});
  if (poses_) {
    const PoseCounts& poses = poses_->counts();
    const drivers::vicon::FrameCounts& frames = poses_->frame_counts();
    models::append_nonzero(out, {{"ros2.poses_unreadable", poses.unreadable},
                                 {"ros2.poses_wrong_frame", poses.wrong_frame},
                                 {"ros2.poses_stale", poses.stale},
                                 {"ros2.poses_early", poses.early},
                                 {"ros2.poses_stuck", frames.poses_stuck},
                                 {"ros2.poses_outlying", frames.poses_outlying},
                                 {"ros2.poses_flipped", frames.poses_flipped},
                                 {"ros2.poses_swapped", frames.poses_swapped},
                                 {"ros2.poses_unconfirmed", frames.poses_unconfirmed},
                                 {"ros2.names_refused", frames.names_refused}});
  }
  DetectionCounts sum;
  for (const auto& source : detections_) {
    const DetectionCounts& each = source->counts();
    sum.unreadable += each.unreadable;
    sum.wrong_frame += each.wrong_frame;
    sum.stale += each.stale;
    sum.early += each.early;
    sum.without_pose += each.without_pose;
    sum.overflowed += each.overflowed;
    sum.unknown_target += each.unknown_target;
    sum.out_of_view += each.out_of_view;
  }
  models::append_nonzero(out, {{"ros2.detections_unreadable", sum.unreadable},
                               {"ros2.detections_wrong_frame", sum.wrong_frame},
                               {"ros2.detections_stale", sum.stale},
                               {"ros2.detections_early", sum.early},
                               {"ros2.detections_without_pose", sum.without_pose},
                               {"ros2.detections_overflowed", sum.overflowed},
                               {"ros2.detections_unknown_target", sum.unknown_target},
                               {"ros2.detections_out_of_view", sum.out_of_view}});
  models::append_latency(out, "latency.ros2_written", latency_);
  return out;
}

}  // namespace vantage::tools::ros2
