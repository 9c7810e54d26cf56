#include "tools/ros2/detection_source.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "drivers/sensor/detected_position.hpp"
#include "drivers/sensor/pose_sensor.hpp"
#include "models/sensor/sensor.hpp"

namespace vantage::tools::ros2 {
namespace {

std::optional<int> number_of(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value)
                                                                  : std::nullopt;
}

}  // namespace

DetectionSource::DetectionSource(const scenario::Scenario& scenario, const std::string& robot,
                                 std::string world_frame)
    : robot_(robot),
      world_frame_(std::move(world_frame)),
      sensor_(scenario.find_robot(robot)->sensor),
      detects_ids_(scenario.find_robot(robot)->detection.detects_ids),
      position_dim_(scenario.estimator.target_model.position_dim),
      targets_(scenario.targets) {}

void DetectionSource::on_frame(std::shared_ptr<const models::MocapFrame> frame) {
  frames_.add(std::move(frame));
}

void DetectionSource::on_message(Bytes cdr, Time now) {
  std::optional<SeenObjects> seen = read_detections(cdr);
  if (!seen) {
    ++counts_.unreadable;
    return;
  }
  const Duration age = now - seen->stamp;
  if (age > kAgeMax || age < -kEarlyMax) {
    ++(age > kAgeMax ? counts_.stale : counts_.early);
    return;
  }
  if (seen->frame != world_frame_ && seen->frame != robot_) {
    ++counts_.wrong_frame;
    return;
  }
  if (waiting_.size() == kWaitingMax) {
    waiting_.pop_front();
    ++counts_.overflowed;
  }
  waiting_.push_back(std::move(*seen));
}

std::optional<models::RobotMeasurement> DetectionSource::next(Time now) {
  while (!waiting_.empty()) {
    const SeenObjects& first = waiting_.front();
    const bool has_later_frame = frames_.reaches(first.stamp);
    if (!has_later_frame && now - first.stamp <= kAgeMax) {
      return std::nullopt;
    }
    const SeenObjects seen = std::move(waiting_.front());
    waiting_.pop_front();
    if (auto made = has_later_frame ? measurement(seen) : std::nullopt) {
      return made;
    }
    ++counts_.without_pose;
  }
  return std::nullopt;
}

std::optional<models::RobotMeasurement> DetectionSource::measurement(const SeenObjects& seen) {
  std::optional<drivers::FrameHistory::Found> found = frames_.at(seen.stamp);
  std::optional<models::RobotMeasurement> out =
      found ? drivers::empty_measurement(found->frame, robot_, false) : std::nullopt;
  if (!out) {
    return std::nullopt;
  }
  for (const SeenObject& object : seen.objects) {
    add(object, seen.frame == world_frame_, found->frame.find(robot_)->world_from_body, *out);
  }
  out->inputs = std::move(found->inputs);
  return out;
}

void DetectionSource::add(const SeenObject& object, bool is_world, const Pose3& world_from_body,
                          models::RobotMeasurement& out) {
  const std::optional<int> target = target_of(object);
  if (!target) {
    ++counts_.unknown_target;
    return;
  }
  const Eigen::Vector3d world_m =
      is_world ? object.position_m : world_from_body * object.position_m;
  const Eigen::Matrix3d turn = is_world ? Eigen::Matrix3d::Identity().eval()
                                        : world_from_body.rotation.toRotationMatrix().eval();
  const auto made =
      drivers::measurement_at(sensor_, out.viewpoint, world_m,
                              turn * object.covariance_m2 * turn.transpose(), position_dim_);
  if (!made) {
    ++counts_.out_of_view;
    return;
  }
  out.detections.push_back({*target, *made});
}

std::optional<int> DetectionSource::target_of(const SeenObject& object) const {
  if (!detects_ids_) {
    return models::kNoTargetId;
  }
  for (const std::string& name : {object.id, object.class_id}) {
    const auto number = number_of(name);
    const auto found =
        std::find_if(targets_.begin(), targets_.end(), [&](const scenario::TargetSpec& target) {
          return target.name == name || number == target.id;
        });
    if (found != targets_.end()) {
      return found->id;
    }
  }
  return std::nullopt;
}

}  // namespace vantage::tools::ros2
