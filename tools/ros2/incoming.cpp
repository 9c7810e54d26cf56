#include "tools/ros2/incoming.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "tools/ros2/cdr_reader.hpp"

namespace vantage::tools::ros2 {
namespace {

constexpr double kPositionMax_m = 1e5;
constexpr std::size_t kHeaderBytes = 12;  // time and an empty text without its NUL
constexpr std::size_t kPoseBytes = 56;
constexpr std::size_t kCovarianceNumbers = 36;
constexpr int kCovarianceDim = 6;

Time read_time(CdrReader& in) {
  constexpr std::int64_t kPerSecond_us = 1'000'000;
  constexpr std::uint32_t kPerMicrosecond_ns = 1'000;
  const std::int64_t seconds = in.number<std::int32_t>();
  const std::uint32_t nanoseconds = in.number<std::uint32_t>();
  return from_utime(seconds * kPerSecond_us + nanoseconds / kPerMicrosecond_ns);
}

Eigen::Vector3d read_vector(CdrReader& in) {
  const double x = in.number<double>();
  const double y = in.number<double>();
  const double z = in.number<double>();
  return {x, y, z};
}

/// Reads x, y, z, w.
Quaternion read_quaternion(CdrReader& in) {
  const double x = in.number<double>();
  const double y = in.number<double>();
  const double z = in.number<double>();
  const double w = in.number<double>();
  return {w, x, y, z};
}

Pose3 read_pose(CdrReader& in) {
  Pose3 pose;
  pose.translation_m = read_vector(in);
  pose.rotation = read_quaternion(in);
  return pose;
}

bool is_position(const Eigen::Vector3d& position_m) {
  return position_m.allFinite() && position_m.cwiseAbs().maxCoeff() <= kPositionMax_m;
}

/// Normalises the rotation; returns false if the position or the rotation is invalid.
bool normalise(Pose3& pose) {
  constexpr double kNormError = 0.01;  // senders may round numbers
  const double norm = pose.rotation.norm();
  if (!is_position(pose.translation_m) || !(std::abs(norm - 1.0) <= kNormError)) {
    return false;
  }
  pose.rotation.coeffs() /= norm;
  return true;
}

using Covariance = std::array<double, kCovarianceNumbers>;

Covariance read_covariance(CdrReader& in) {
  Covariance out{};
  for (double& each : out) {
    each = in.number<double>();
  }
  return out;
}

void read_header(CdrReader& in, Time& stamp, std::string& frame) {
  stamp = read_time(in);
  frame = in.text();
}

std::optional<SeenObject> read_object(CdrReader& in) {
  constexpr std::size_t kResultBytes = 4 + 8 + kPoseBytes + kCovarianceNumbers * sizeof(double);
  SeenObject out;
  Time stamp{};
  std::string frame;
  read_header(in, stamp, frame);  // the header of the array is used instead
  const std::size_t results = in.count(kResultBytes);
  double best_score = 0.0;
  for (std::size_t i = 0; i < results && in.ok(); ++i) {
    const std::string class_id(in.text());
    const double score = in.number<double>();
    const Pose3 pose = read_pose(in);
    const Covariance covariance = read_covariance(in);
    if (i > 0 && !(score > best_score)) {
      continue;
    }
    best_score = score;
    out.class_id = class_id;
    out.position_m = pose.translation_m;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        out.covariance_m2(row, column) =
            covariance[static_cast<std::size_t>(row * kCovarianceDim + column)];
      }
    }
  }
  const Pose3 centre = read_pose(in);
  read_vector(in);  // skips the size of the box
  out.id = in.text();
  if (results == 0) {
    out.position_m = centre.translation_m;
  }
  const Eigen::Matrix3d symmetric = 0.5 * (out.covariance_m2 + out.covariance_m2.transpose());
  const bool is_possible = in.ok() && is_position(out.position_m) && symmetric.allFinite() &&
                           symmetric.diagonal().minCoeff() >= 0.0;
  out.covariance_m2 = symmetric;
  return is_possible ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace

std::string_view type_of(scenario::Ros2PoseType type) {
  switch (type) {
    case scenario::Ros2PoseType::kPose:
      return "geometry_msgs/msg/PoseStamped";
    case scenario::Ros2PoseType::kPoseWithCovariance:
      return "geometry_msgs/msg/PoseWithCovarianceStamped";
    case scenario::Ros2PoseType::kOdometry:
      return "nav_msgs/msg/Odometry";
    case scenario::Ros2PoseType::kTransforms:
      return "tf2_msgs/msg/TFMessage";
  }
  return "";
}

std::optional<std::vector<StampedPose>> read_poses(scenario::Ros2PoseType type, Bytes cdr) {
  const bool is_list = type == scenario::Ros2PoseType::kTransforms;
  const bool has_child = is_list || type == scenario::Ros2PoseType::kOdometry;
  CdrReader in(cdr);
  const std::size_t poses = is_list ? in.count(kHeaderBytes + kPoseBytes) : 1;
  std::vector<StampedPose> out;
  out.reserve(poses);
  for (std::size_t i = 0; i < poses; ++i) {
    StampedPose pose;
    read_header(in, pose.stamp, pose.frame);
    if (has_child) {
      pose.child = in.text();
    }
    pose.frame_from_body = read_pose(in);
    pose.is_possible = normalise(pose.frame_from_body);
    if (!in.ok() || (!is_list && !pose.is_possible)) {
      return std::nullopt;
    }
    out.push_back(std::move(pose));
  }
  return in.ok() ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<SeenObjects> read_detections(Bytes cdr) {
  constexpr std::size_t kObjectBytes = kHeaderBytes + 4 + kPoseBytes + 24 + 4;
  CdrReader in(cdr);
  SeenObjects out;
  read_header(in, out.stamp, out.frame);
  const std::size_t objects = in.count(kObjectBytes);
  for (std::size_t i = 0; i < objects; ++i) {
    std::optional<SeenObject> object = read_object(in);
    if (!object) {
      return std::nullopt;
    }
    out.objects.push_back(std::move(*object));
  }
  return in.ok() ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace vantage::tools::ros2
