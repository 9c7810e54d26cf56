#include "logs/export/ros2_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/export/cdr.hpp"
#include "models/mapping/beam.hpp"

namespace vantage::logs::ros2 {
namespace {

constexpr std::int64_t kUtime = 1'700'000'000'250'000;
constexpr Time kTime = from_utime(kUtime);

/// Reads plain little-endian CDR by its specification: after a header of four bytes, every number
/// begins at a multiple of its own size.
class Reader {
 public:
  explicit Reader(const Message& message) : bytes_(message.cdr) {
    EXPECT_EQ(bytes_.substr(0, 4), std::string("\0\1\0\0", 4));
  }
  ~Reader() { EXPECT_EQ(at_, bytes_.size()) << "bytes remain after the last field"; }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  Reader(Reader&&) = delete;
  Reader& operator=(Reader&&) = delete;

  template <class Number>
  Number number() {
    while ((at_ - 4) % sizeof(Number) != 0) {
      ++at_;
    }
    Number out{};
    if (at_ + sizeof(Number) > bytes_.size()) {
      ADD_FAILURE() << "the message ends too early";
      return out;
    }
    std::memcpy(&out, bytes_.data() + at_, sizeof(Number));
    at_ += sizeof(Number);
    return out;
  }
  std::uint32_t count() { return number<std::uint32_t>(); }
  std::string text() {
    const std::uint32_t size = count();  // including the NUL
    const std::string out = bytes_.substr(at_, size - 1);
    at_ += size;
    EXPECT_EQ(bytes_.at(at_ - 1), '\0');
    return out;
  }
  /// Reads seconds and nanoseconds; returns their sum in ns.
  std::int64_t time_ns() {
    const auto seconds = number<std::int32_t>();
    const auto nanoseconds = number<std::uint32_t>();
    EXPECT_LT(nanoseconds, 1'000'000'000U);
    return std::int64_t{1'000'000'000} * seconds + nanoseconds;
  }
  void expect_header(std::int64_t utime, const std::string& frame) {
    EXPECT_EQ(time_ns(), 1000 * utime);
    EXPECT_EQ(text(), frame);
  }
  template <class Number = double>
  std::vector<Number> numbers(std::size_t count) {
    std::vector<Number> out;
    for (std::size_t i = 0; i < count; ++i) {
      out.push_back(number<Number>());
    }
    return out;
  }
  /// Reads a quaternion that must be a rotation about the vertical; returns its angle.
  double yaw_rad() {
    const auto q = numbers(4);  // x, y, z, w
    EXPECT_EQ(q[0], 0.0);
    EXPECT_EQ(q[1], 0.0);
    EXPECT_NEAR(std::hypot(q[2], q[3]), 1.0, 1e-12);
    return std::remainder(2.0 * std::atan2(q[2], q[3]), 2.0 * kPi);
  }

 private:
  std::string bytes_;
  std::size_t at_ = 4;
};

using Numbers = std::vector<double>;

TEST(Cdr, AlignsEachNumberToItsSize) {
  Cdr out;
  out.number(std::uint8_t{1}).number(std::uint16_t{2}).number(std::uint8_t{3}).number(4.0);
  out.text("ab").number(std::uint8_t{5}).number(std::uint32_t{6});
  Reader in({"", "", {}, out.bytes()});
  EXPECT_EQ(in.number<std::uint8_t>(), 1);
  EXPECT_EQ(in.number<std::uint16_t>(), 2);
  EXPECT_EQ(in.number<std::uint8_t>(), 3);
  EXPECT_EQ(in.number<double>(), 4.0);
  EXPECT_EQ(in.text(), "ab");
  EXPECT_EQ(in.number<std::uint8_t>(), 5);
  EXPECT_EQ(in.number<std::uint32_t>(), 6U);
  EXPECT_EQ(out.bytes().size(), 4U + 16U + 4U + 3U + 1U + 4U);
}

// Nanoseconds are not negative, even for times before 1970.
TEST(ToRos2, WritesTransformsOfVisibleBodies) {
  for (const std::int64_t utime : {kUtime, std::int64_t{-1}, std::int64_t{-1'000'000},
                                   std::int64_t{-1'250'000}, std::int64_t{0}}) {
    models::MocapFrame frame;
    frame.stamp.time = from_utime(utime);
    const Quaternion turn(0.5, -0.1, 0.2, 0.3);
    frame.bodies = {{"Q1", {{1.0, 2.0, 3.0}, turn}, false},
                    {"R1", {{9.0, 9.0, 9.0}, turn}, true},
                    {"Q2", {{4.0, 5.0, 6.0}, turn}, false}};
    models::TruthFrame truth;
    truth.stamp.time = frame.stamp.time;
    for (const std::size_t i : {0U, 2U}) {
      truth.bodies.push_back({frame.bodies[i].name, i == 2 ? 7 : -1,
                              frame.bodies[i].world_from_body, Eigen::Vector3d::Zero()});
    }
    for (const Message& message : {to_ros2(frame).at(0), to_ros2(truth).at(0)}) {
      EXPECT_EQ(message.type, "tf2_msgs/msg/TFMessage");
      EXPECT_EQ(message.valid, from_utime(utime));
      Reader in(message);
      ASSERT_EQ(in.count(), 2U);
      for (const std::size_t i : {0U, 2U}) {
        in.expect_header(utime, "world");
        EXPECT_EQ(in.text(), frame.bodies[i].name);
        EXPECT_EQ(in.numbers(3), i == 0 ? (Numbers{1.0, 2.0, 3.0}) : (Numbers{4.0, 5.0, 6.0}));
        EXPECT_EQ(in.numbers(4), (Numbers{-0.1, 0.2, 0.3, 0.5})) << "x, y, z, w";
      }
    }
    EXPECT_EQ(to_ros2(frame).at(0).topic, "/tf");
    EXPECT_EQ(to_ros2(truth).at(0).topic, "/truth/tf");
  }
}

TEST(ToRos2, WritesPlanarAndSpatialBeliefs) {
  models::RobotBelief belief;
  belief.stamp.time = kTime;
  belief.robot = "Q1";
  Eigen::Matrix4d root;
  root << 2.0, 0.3, 0.4, 0.1, 0.0, 1.0, 0.2, 0.5, 0.0, 0.0, 1.5, 0.3, 0.0, 0.0, 0.0, 0.7;
  const Eigen::Matrix4d covariance = root * root.transpose();
  for (const Eigen::Index dim : {2, 3, 4}) {  // 4: planar, with velocities
    models::TargetBelief target;
    target.target_id = static_cast<int>(10 + dim);
    target.information = *models::to_information(
        {Eigen::Vector4d(1.0, -2.0, 3.0, 4.0).head(dim), covariance.topLeftCorner(dim, dim)});
    belief.targets.push_back(target);
  }
  models::TargetBelief nothing;
  nothing.information.matrix = Eigen::Matrix2d::Zero();
  nothing.information.vector = Eigen::Vector2d::Zero();
  belief.targets.push_back(nothing);
  const std::vector<Message> messages = to_ros2(belief);
  ASSERT_EQ(messages.size(), 3U) << "targets without information are omitted";
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(messages[k].topic, "/Q1/target_" + std::to_string(12 + k));
    EXPECT_EQ(messages[k].type, "geometry_msgs/msg/PoseWithCovarianceStamped");
    EXPECT_EQ(messages[k].valid, kTime);
    Reader in(messages[k]);
    in.expect_header(kUtime, "world");
    const Numbers place_m = in.numbers(3);
    EXPECT_NEAR(place_m[0], 1.0, 1e-9);
    EXPECT_NEAR(place_m[1], -2.0, 1e-9);
    EXPECT_NEAR(place_m[2], k == 1 ? 3.0 : 0.0, 1e-9);
    EXPECT_EQ(in.yaw_rad(), 0.0);
    const Eigen::Index known = k == 1 ? 3 : 2;
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = 0; j < 6; ++j) {
        const bool is_known = i < known && j < known;
        EXPECT_NEAR(in.number<double>(),
                    is_known ? covariance(i, j)
                    : i == j ? 1e6
                             : 0.0,
                    1e-9)
            << i << " " << j;
      }
    }
  }
}

// Each range is written as measured, for any field of view; the angles continue beyond π.
TEST(ToRos2, WritesEachRangeAtTheBearingOfItsBeam) {
  for (const double fov_rad : {kPi, 0.5, 2.0 * kPi}) {
    for (const int beams : {1, 2, 3, 8}) {
      models::RangeScan scan;
      scan.stamp.time = kTime;
      scan.robot = "Q1";
      scan.field_of_view_rad = fov_rad;
      scan.range_max_m = 1.75;
      for (int i = 0; i < beams; ++i) {
        scan.ranges_m.push_back(0.125 * (i + 1));
      }
      const std::vector<Message> messages = to_ros2(scan);
      ASSERT_EQ(messages.size(), 1U);
      EXPECT_EQ(messages[0].topic, "/Q1/scan");
      EXPECT_EQ(messages[0].type, "sensor_msgs/msg/LaserScan");
      EXPECT_EQ(messages[0].valid, kTime);
      Reader in(messages[0]);
      in.expect_header(kUtime, "Q1");
      const std::vector<float> floats = in.numbers<float>(7);
      const Numbers numbers(floats.begin(), floats.end());
      const models::BeamSensor sensor{beams, fov_rad, 0.0, 1.75, 0.01};
      for (int i = 0; i < beams; ++i) {
        const double angle_rad = numbers[0] + i * numbers[2];
        EXPECT_NEAR(std::remainder(angle_rad - sensor.bearing_rad(i), 2.0 * kPi), 0.0, 1e-5);
      }
      EXPECT_NEAR(numbers[1], numbers[0] + (beams - 1) * numbers[2], 1e-5)
          << "bearing of the last beam";
      EXPECT_GE(numbers[2], 0.0);
      EXPECT_EQ(numbers[3], 0.0) << "all beams at the same time";
      EXPECT_EQ(numbers[4], 0.0);
      EXPECT_EQ(numbers[5], 0.0);
      EXPECT_EQ(numbers[6], 1.75);
      ASSERT_EQ(in.count(), static_cast<std::uint32_t>(beams));
      for (int i = 0; i < beams; ++i) {
        EXPECT_EQ(in.number<float>(), 0.125F * static_cast<float>(i + 1));
      }
      EXPECT_EQ(in.count(), 0U) << "no intensities";
      scan.jammed = true;
      EXPECT_TRUE(to_ros2(scan).empty());
      scan.jammed = false;
      scan.ranges_m.clear();
      EXPECT_TRUE(to_ros2(scan).empty());
    }
  }
}

TEST(ToRos2, WritesOccupancyFromHitsMinusPasses) {
  models::RobotMap map;
  map.stamp.time = kTime;
  map.robot = "Q2";
  map.grid = {{-4.0, -2.5}, 0.25, 3, 2};
  map.own_looks = {9, 9, 9, 9, 9, 9};
  map.team_looks = {0, 1, -1, 300, -300, 0};
  const Message message = to_ros2(map).at(0);
  EXPECT_EQ(message.topic, "/Q2/map");
  EXPECT_EQ(message.type, "nav_msgs/msg/OccupancyGrid");
  EXPECT_EQ(message.valid, kTime);
  Reader in(message);
  in.expect_header(kUtime, "world");
  EXPECT_EQ(in.time_ns(), 1000 * kUtime);
  EXPECT_EQ(in.number<float>(), 0.25F);
  EXPECT_EQ(in.count(), 3U) << "columns";
  EXPECT_EQ(in.count(), 2U);
  EXPECT_EQ(in.numbers(3), (Numbers{-4.0, -2.5, 0.0}));
  EXPECT_EQ(in.yaw_rad(), 0.0);
  ASSERT_EQ(in.count(), 6U);
  EXPECT_EQ(in.numbers<std::int8_t>(6), (std::vector<std::int8_t>{-1, 100, 0, 100, 0, -1}));
}

// A plan has one pose per step from start to end, and a single pose if its duration is zero. The
// number of poses is limited for any plan.
TEST(ToRos2, WritesAPlanAsOnePosePerStep) {
  for (const double duration_s : {1.2, 1.0, 0.0, 1e5}) {
    models::RobotPlan plan;
    plan.robot = "Q1";
    plan.step_s = 0.5;
    plan.stamp.time = kTime + from_seconds(99.0);
    plan.trajectory = {kTime, {1.0, 2.0, 0.5}, 1.5, {{{0.5, 0.25}, duration_s, 0.0}}};
    const Message message = to_ros2(plan).at(0);
    EXPECT_EQ(message.topic, "/Q1/plan");
    EXPECT_EQ(message.type, "nav_msgs/msg/Path");
    EXPECT_EQ(message.valid, kTime) << "start time of the plan";
    Reader in(message);
    in.expect_header(kUtime, "world");
    const std::uint32_t poses = in.count();
    EXPECT_EQ(poses, duration_s == 1.2   ? 4U
                     : duration_s == 1.0 ? 3U
                     : duration_s == 0.0 ? 1U
                                         : 1000U);
    for (std::uint32_t k = 0; k < poses; ++k) {
      const double at_s = std::min(0.5 * k, duration_s);
      const Time at = kTime + from_seconds(at_s);
      const Pose2 pose = models::at(plan.trajectory, at).world_from_body;
      in.expect_header(to_utime(at), "world");
      EXPECT_EQ(in.numbers(3), (Numbers{pose.x_m, pose.y_m, 1.5}));
      EXPECT_NEAR(std::remainder(in.yaw_rad() - pose.yaw_rad, 2.0 * kPi), 0.0, 1e-9);
    }
  }
}

TEST(ToRos2, WritesKnownBatteryValues) {
  models::VehicleStatus status;
  status.stamp.time = kTime;
  status.robot = "Q3";
  status.battery_share = 0.625;
  const Message message = to_ros2(status).at(0);
  EXPECT_EQ(message.topic, "/Q3/battery");
  EXPECT_EQ(message.type, "sensor_msgs/msg/BatteryState");
  EXPECT_EQ(message.valid, kTime);
  Reader in(message);
  in.expect_header(kUtime, "Q3");
  for (const float unknown : in.numbers<float>(6)) {
    EXPECT_TRUE(std::isnan(unknown));
  }
  EXPECT_EQ(in.number<float>(), 0.625F);
  // Status, health and technology are 0 (unknown); the battery is present (1).
  EXPECT_EQ(in.numbers<std::uint8_t>(4), (std::vector<std::uint8_t>{0, 0, 0, 1}));
  EXPECT_EQ(in.count(), 0U);
  EXPECT_EQ(in.count(), 0U);
  EXPECT_EQ(in.text(), "");
  EXPECT_EQ(in.text(), "");
}

TEST(ToRos2, WritesProcessHealth) {
  models::ProcessHealth health;
  health.stamp.time = kTime;
  health.process = "SIM";
  health.counters = {{"VICON.lost", 3}, {"loops", -4}};
  const std::vector<std::string> words = {"starting", "running", "degraded", "stopping"};
  for (std::size_t i = 0; i < words.size(); ++i) {
    health.state = static_cast<models::ProcessState>(i);
    const Message message = to_ros2(health).at(0);
    EXPECT_EQ(message.topic, "/diagnostics");
    EXPECT_EQ(message.type, "diagnostic_msgs/msg/DiagnosticArray");
    EXPECT_EQ(message.valid, kTime);
    Reader in(message);
    in.expect_header(kUtime, "");
    ASSERT_EQ(in.count(), 1U);
    EXPECT_EQ(in.number<std::uint8_t>(), i == 2 ? 1 : 0) << "WARN, or OK";
    EXPECT_EQ(in.text(), "SIM");
    EXPECT_EQ(in.text(), words[i]);
    EXPECT_EQ(in.text(), "");
    ASSERT_EQ(in.count(), 2U);
    EXPECT_EQ(in.text(), "VICON.lost");
    EXPECT_EQ(in.text(), "3");
    EXPECT_EQ(in.text(), "loops");
    EXPECT_EQ(in.text(), "-4");
  }
}

// Each type that a definition uses is defined after it, exactly once.
TEST(DefinitionOf, ContainsEachUsedTypeOnce) {
  const std::string line(80, '=');
  for (const char* type :
       {"tf2_msgs/msg/TFMessage", "geometry_msgs/msg/PoseWithCovarianceStamped",
        "sensor_msgs/msg/LaserScan", "nav_msgs/msg/OccupancyGrid", "nav_msgs/msg/Path",
        "sensor_msgs/msg/BatteryState", "diagnostic_msgs/msg/DiagnosticArray"}) {
    const std::string text = definition_of(type);
    EXPECT_TRUE(text.starts_with("std_msgs/Header header\n") ||
                text.starts_with("geometry_msgs/TransformStamped[] transforms\n"))
        << type;
    std::multiset<std::string> defined;
    std::set<std::string> named;
    std::size_t at = 0;
    bool is_name_next = false;
    while (at < text.size()) {
      const std::size_t end = text.find('\n', at);
      const std::string each = text.substr(at, end - at);
      at = end + 1;
      if (each == line) {
        is_name_next = true;
      } else if (is_name_next) {
        ASSERT_TRUE(each.starts_with("MSG: ")) << each;
        defined.insert(each.substr(5));
        is_name_next = false;
      } else if (const std::string word = each.substr(0, each.find_first_of(" ["));
                 word.find('/') != std::string::npos) {
        named.insert(word);
      }
    }
    EXPECT_EQ(std::multiset<std::string>(named.begin(), named.end()), defined) << type;
  }
}

}  // namespace
}  // namespace vantage::logs::ros2
