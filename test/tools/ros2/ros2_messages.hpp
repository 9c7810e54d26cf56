#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "logs/export/cdr.hpp"

// ROS 2 messages as bytes, for tests of their readers.

namespace vantage::test {

inline std::span<const std::uint8_t> bytes_of(const std::string& cdr) {
  return {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()};  // NOLINT
}

inline void add_header(logs::Cdr& out, Time stamp, std::string_view frame) {
  out.number(static_cast<std::int32_t>(to_utime(stamp) / 1'000'000));
  out.number(static_cast<std::uint32_t>(to_utime(stamp) % 1'000'000 * 1'000)).text(frame);
}

inline void add_pose(logs::Cdr& out, const Pose3& pose) {
  for (const double each : pose.translation_m) {
    out.number(each);
  }
  const Quaternion& turn = pose.rotation;
  out.number(turn.x()).number(turn.y()).number(turn.z()).number(turn.w());
}

inline void add_covariance(logs::Cdr& out, double position_variance_m2) {
  for (int i = 0; i < 36; ++i) {
    out.number(i == 0 || i == 7 || i == 14 ? position_variance_m2 : 0.0);
  }
}

inline std::string pose_message(Time stamp, std::string_view frame, const Pose3& pose) {
  logs::Cdr out;
  add_header(out, stamp, frame);
  add_pose(out, pose);
  return out.bytes();
}

inline std::string transform_message(Time stamp, std::string_view frame,
                                     const std::vector<std::pair<std::string, Pose3>>& children) {
  logs::Cdr out;
  out.count(children.size());
  for (const auto& [child, pose] : children) {
    add_header(out, stamp, frame);
    out.text(child);
    add_pose(out, pose);
  }
  return out.bytes();
}

struct ObjectText {
  std::string id;
  std::string class_id;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double variance_m2 = 0.0;
};

/// Returns a Detection3DArray. Each object has a second hypothesis with a lower score elsewhere.
inline std::string detections_message(Time stamp, std::string_view frame,
                                      const std::vector<ObjectText>& objects) {
  const Pose3 elsewhere{{99.0, 99.0, 99.0}, Quaternion::Identity()};
  logs::Cdr out;
  add_header(out, stamp, frame);
  out.count(objects.size());
  for (const ObjectText& object : objects) {
    add_header(out, stamp, frame);
    out.count(2);
    out.text("other").number(0.1);
    add_pose(out, elsewhere);
    add_covariance(out, 7.0);
    out.text(object.class_id).number(0.9);
    add_pose(out, {object.position_m, Quaternion::Identity()});
    add_covariance(out, object.variance_m2);
    add_pose(out, elsewhere);
    out.number(1.0).number(1.0).number(1.0).text(object.id);
  }
  return out.bytes();
}

}  // namespace vantage::test
