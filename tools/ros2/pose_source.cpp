#include "tools/ros2/pose_source.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "drivers/vicon/driver.hpp"

namespace vantage::tools::ros2 {

PoseSource::PoseSource(const scenario::Scenario& scenario, std::string world_frame,
                       drivers::vicon::FrameFilter::Publish publish)
    : world_frame_(std::move(world_frame)),
      filter_(drivers::vicon::gate_of(scenario.mocap, scenario.planner.separation_m),
              from_seconds(scenario.mocap.latency_s), std::move(publish)),
      assembly_([this](const drivers::vicon::SeenFrame& frame) { filter_.accept(frame); }) {}

void PoseSource::on_message(const scenario::Ros2PoseInput& input, Bytes cdr,
                            drivers::vicon::Moment now) {
  const auto poses = read_poses(input.type, cdr);
  if (!poses) {
    ++counts_.unreadable;
    return;
  }
  const bool is_tree = input.type == scenario::Ros2PoseType::kTransforms;
  for (const StampedPose& pose : *poses) {
    if (pose.frame != world_frame_) {
      // a tree of frames also contains poses relative to other frames
      counts_.wrong_frame += is_tree ? 0 : 1;
      continue;
    }
    if (!pose.is_possible) {
      ++counts_.unreadable;  // a lost body; the other bodies of the message are used
      continue;
    }
    add(is_tree ? pose.child : input.body, pose, now);
  }
  assembly_.pass_on_if_complete();
}

void PoseSource::add(const std::string& body, const StampedPose& pose, drivers::vicon::Moment now) {
  const Duration age = now.utime - pose.stamp;
  if (age > kAgeMax || age < -kEarlyMax) {
    ++(age > kAgeMax ? counts_.stale : counts_.early);
    return;
  }
  const bool is_same_frame = assembly_.is_open() && !assembly_.frame().has(body) &&
                             std::chrono::abs(pose.stamp - frame_stamp_) <= kSameFrame;
  if (!is_same_frame) {
    drivers::vicon::SeenFrame& frame = assembly_.begin(now);
    frame.latency_s = to_seconds(std::max(age, Duration{0}));
    frame_stamp_ = pose.stamp;
  }
  drivers::vicon::SeenBody& seen = assembly_.frame().add();
  seen.name = body;
  drivers::vicon::set_pose(seen, pose.frame_from_body.translation_m, pose.frame_from_body.rotation,
                           false, false);
}

}  // namespace vantage::tools::ros2
