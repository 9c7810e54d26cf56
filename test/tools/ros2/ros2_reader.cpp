// ros2_reader SCENARIO: program on the bus and in ROS 2, for the test of `vantage ros2`. Publishes
// VICON, PLAN_Q1 and BELIEF_Q1 on the bus and reads them in ROS 2, with types that idlc generated
// from tools/ros2/messages.idl. Sends a detection in ROS 2 and reads it as MEASUREMENT_Q1 on the
// bus. Exit code 0 if everything arrived with the right content, 1 otherwise.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <dds/dds.h>

#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "messages.h"
#include "models/belief/gaussian.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace {

using namespace vantage;

constexpr double kTolerance = 1e-9;
constexpr double kX_m = 0.5;  // m; x of robot, plan and target
constexpr auto kPatience = std::chrono::seconds(30);

dds_entity_t open_topic(dds_entity_t participant, const dds_topic_descriptor_t& type,
                        const char* name) {
  return dds_create_topic(participant, &type, name, nullptr, nullptr);
}

/// Opens a reader with ROS 2's default quality of service.
dds_entity_t open_reader(dds_entity_t participant, const dds_topic_descriptor_t& type,
                         const char* name) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  const dds_entity_t reader =
      dds_create_reader(participant, open_topic(participant, type, name), qos, nullptr);
  dds_delete_qos(qos);
  return reader;
}

/// One topic: reader, and check of the content of a message.
struct Expectation {
  const char* name;
  dds_entity_t reader;
  std::function<bool(const void*)> is_right;
  bool is_met = false;

  void look() {
    void* sample = nullptr;
    dds_sample_info_t info{};
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      is_met = is_met || (info.valid_data && is_right(sample));
      dds_return_loan(reader, &sample, 1);
      sample = nullptr;
    }
  }
};

template <class Message>
Expectation expect(dds_entity_t participant, const char* name, const dds_topic_descriptor_t& type,
                   std::function<bool(const Message&)> is_right) {
  return {name, open_reader(participant, type, name), [is_right](const void* sample) {
            return is_right(*static_cast<const Message*>(sample));
          }};
}

bool is_near(double value, double expected) { return std::abs(value - expected) < kTolerance; }
bool is_here(const geometry_msgs_msg_dds__Point_& position) { return is_near(position.x, kX_m); }

std::vector<Expectation> expectations(dds_entity_t participant) {
  std::vector<Expectation> out;
  out.push_back(expect<tf2_msgs_msg_dds__TFMessage_>(
      participant, "rt/tf", tf2_msgs_msg_dds__TFMessage__desc, [](const auto& message) {
        return message.transforms._length == 1 &&
               message.transforms._buffer[0].child_frame_id == std::string("Q1") &&
               message.transforms._buffer[0].header.frame_id == std::string("world") &&
               is_near(message.transforms._buffer[0].transform.translation.x, kX_m) &&
               is_near(message.transforms._buffer[0].transform.rotation.w, 1.0);
      }));
  out.push_back(expect<geometry_msgs_msg_dds__PoseStamped_>(
      participant, "rt/Q1/pose", geometry_msgs_msg_dds__PoseStamped__desc,
      [](const auto& message) { return is_here(message.pose.position); }));
  out.push_back(expect<nav_msgs_msg_dds__Path_>(
      participant, "rt/Q1/plan", nav_msgs_msg_dds__Path__desc, [](const auto& message) {
        return message.poses._length > 0 && is_here(message.poses._buffer[0].pose.position);
      }));
  out.push_back(expect<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>(
      participant, "rt/Q1/target_0", geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
      [](const auto& message) {
        return is_here(message.pose.pose.position) && is_near(message.pose.covariance[0], 0.04) &&
               is_near(message.pose.covariance[7], 0.09);
      }));
  // The ellipsoid's diameters are 4σ: 0.04 m (vertical), 0.8 m and 1.2 m.
  out.push_back(expect<visualization_msgs_msg_dds__MarkerArray_>(
      participant, "rt/Q1/beliefs", visualization_msgs_msg_dds__MarkerArray__desc,
      [](const auto& message) {
        if (message.markers._length != 2 || message.markers._buffer[0].action != 3) {
          return false;
        }
        const auto& marker = message.markers._buffer[1];
        return marker.ns == std::string("Q1/beliefs") && is_here(marker.pose.position) &&
               is_near(marker.scale.x, 0.04) && is_near(marker.scale.y, 0.8) &&
               is_near(marker.scale.z, 1.2) && marker.lifetime.sec == 2;
      }));
  out.push_back(expect<sensor_msgs_msg_dds__BatteryState_>(
      participant, "rt/Q1/battery", sensor_msgs_msg_dds__BatteryState__desc,
      [](const auto& message) { return is_near(message.percentage, 0.5) && message.present; }));
  out.push_back(expect<diagnostic_msgs_msg_dds__DiagnosticArray_>(
      participant, "rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc,
      [](const auto& message) {
        return message.status._length == 1 && message.status._buffer[0].name == std::string("ROS2");
      }));
  return out;
}

models::Stamp stamp_of(Time now) { return {now, 0, 0}; }

void publish(bus::Bus& bus, Time now) {
  models::MocapFrame frame;
  frame.stamp = stamp_of(now);
  frame.arrival = now;
  frame.bodies = {{"Q1", lift({kX_m, 0.0, 0.0}, 1.0), false}};
  bus.publish(bus::kVicon, frame);
  models::RobotPlan plan;
  plan.stamp = stamp_of(now);
  plan.robot = "Q1";
  plan.trajectory.start_time = now;
  plan.trajectory.start = {kX_m, 0.0, 0.0};
  plan.trajectory.height_m = 1.0;
  bus.publish(bus::plan_channel("Q1"), plan);
  models::RobotBelief belief;
  belief.stamp = stamp_of(now);
  belief.robot = "Q1";
  Eigen::Matrix2d covariance_m2 = Eigen::Vector2d(0.04, 0.09).asDiagonal();
  models::TargetBelief target;
  target.information = *models::to_information({Eigen::Vector2d(kX_m, 1.0), covariance_m2});
  target.last_seen = now;
  belief.targets.push_back(target);
  bus.publish(bus::belief_channel("Q1"), belief);
  models::VehicleStatus status;
  status.stamp = stamp_of(now);
  status.robot = "Q1";
  status.battery_share = 0.5;
  bus.publish(bus::vehicle_channel("Q1"), status);
}

/// Sends the position of target 0 in the frame of the robot, 0.6 m ahead.
void send_detection(dds_entity_t writer, Time now) {
  constexpr std::int64_t kPerSecond = 1'000'000;
  std::string empty;
  std::string frame = "Q1";
  std::string id = "0";
  vision_msgs_msg_dds__Detection3DArray_ message{};
  vision_msgs_msg_dds__Detection3D_ detection{};
  message.header.stamp.sec = static_cast<std::int32_t>(to_utime(now) / kPerSecond);
  message.header.stamp.nanosec = static_cast<std::uint32_t>(to_utime(now) % kPerSecond * 1'000);
  message.header.frame_id = frame.data();
  detection.header.frame_id = empty.data();
  detection.id = id.data();
  detection.bbox.center.position.x = 0.6;
  message.detections._buffer = &detection;
  message.detections._length = message.detections._maximum = 1;
  dds_write(writer, &message);
}

bool run(const std::string& path) {
  const scenario::Scenario scenario = scenario::load_scenario(path);
  const auto transport = bus::open_transport(scenario.network.url);
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SteadyClock clock;
  const dds_entity_t participant = dds_create_participant(DDS_DOMAIN_DEFAULT, nullptr, nullptr);
  std::vector<Expectation> topics = expectations(participant);
  const dds_entity_t writer = dds_create_writer(
      participant,
      open_topic(participant, vision_msgs_msg_dds__Detection3DArray__desc, "rt/Q1/detections"),
      nullptr, nullptr);
  bool is_measured = false;
  bus.subscribe<models::RobotMeasurement>(
      bus::measurement_channel("Q1"), [&](const models::RobotMeasurement& message) {
        is_measured = is_measured ||
                      (message.detections.size() == 1 && message.detections[0].target_id == 0 &&
                       is_near(message.detections[0].measurement.z(0), 0.6));
      });
  const Time end = clock.now() + kPatience;
  const auto is_waiting = [&] {
    return !is_measured || std::any_of(topics.begin(), topics.end(),
                                       [](const Expectation& each) { return !each.is_met; });
  };
  while (is_waiting() && clock.now() < end) {
    publish(bus, clock.now());
    send_detection(writer, clock.now());
    bus.handle(std::chrono::milliseconds(20));
    for (Expectation& each : topics) {
      each.look();
    }
  }
  for (const Expectation& each : topics) {
    std::printf("%-20s %s\n", each.name, each.is_met ? "ok" : "MISSING");
  }
  std::printf("%-20s %s\n", "MEASUREMENT_Q1", is_measured ? "ok" : "MISSING");
  const bool is_complete = !is_waiting();
  dds_delete(participant);
  return is_complete;
}

}  // namespace

int main(int argc, char** argv) { return argc == 2 && run(argv[1]) ? 0 : 1; }
