#include "tools/ros2/pose_source.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/tools/ros2/ros2_messages.hpp"

namespace vantage::tools::ros2 {
namespace {

using scenario::Ros2PoseInput;
using scenario::Ros2PoseType;

class PoseSourceTest : public testing::Test {
 protected:
  static Pose3 at(double x_m) { return {{x_m, 0.0, 1.0}, Quaternion::Identity()}; }
  drivers::vicon::Moment moment() const { return {now_, now_.time_since_epoch()}; }
  void send(const std::string& body, double x_m, Duration age, const std::string& frame = "world") {
    const Ros2PoseInput input{"/" + body, Ros2PoseType::kPose, body};
    source_.on_message(input, test::bytes_of(test::pose_message(now_ - age, frame, at(x_m))),
                       moment());
  }

  Time now_ = from_utime(1'700'000'000'000'000);
  std::vector<models::MocapFrame> frames_;
  PoseSource source_{scenario::Scenario{}, "world",
                     [this](const models::MocapFrame& frame) { frames_.push_back(frame); }};
};

TEST_F(PoseSourceTest, PublishesTheStampAsCaptureTime) {
  for (int i = 0; i < 5; ++i, now_ += Duration{10'000}) {
    send("Q1", 0.01 * i, Duration{3'000});
    send("Q2", 2.0 + 0.01 * i, Duration{2'500});  // within kSameFrame
    source_.on_time(moment());
  }
  source_.on_time({now_, now_.time_since_epoch()});
  ASSERT_EQ(frames_.size(), 5U);
  EXPECT_EQ(frames_.back().stamp.time, now_ - Duration{13'000});
  ASSERT_NE(frames_.back().find("Q2"), nullptr);
  EXPECT_FALSE(frames_.back().find("Q2")->occluded);
  EXPECT_EQ(frames_.back().find("Q2")->world_from_body.translation_m.x(), 2.04);
}

TEST_F(PoseSourceTest, RefusesStaleEarlyAndForeignPoses) {
  send("Q1", 0.0, PoseSource::kAgeMax + Duration{1});
  send("Q1", 0.0, -PoseSource::kEarlyMax - Duration{1});
  send("Q1", 0.0, Duration{0}, "map");
  source_.on_message({"/Q1", Ros2PoseType::kPose, "Q1"}, {}, moment());
  now_ += Duration{1'000'000};
  source_.on_time(moment());
  EXPECT_TRUE(frames_.empty());
  EXPECT_EQ(source_.counts().stale, 1);
  EXPECT_EQ(source_.counts().early, 1);
  EXPECT_EQ(source_.counts().wrong_frame, 1);
  EXPECT_EQ(source_.counts().unreadable, 1);
}

TEST_F(PoseSourceTest, UsesOnlyTransformsFromTheWorldFrame) {
  const Ros2PoseInput input{"/mocap/tf", Ros2PoseType::kTransforms, ""};
  source_.on_message(
      input, test::bytes_of(test::transform_message(now_, "world", {{"Q1", at(1.0)}})), moment());
  source_.on_message(
      input, test::bytes_of(test::transform_message(now_, "Q1", {{"camera", at(1.0)}})), moment());
  now_ += Duration{10'000};
  source_.on_time(moment());
  ASSERT_EQ(frames_.size(), 1U);
  ASSERT_EQ(frames_[0].bodies.size(), 1U);
  EXPECT_EQ(frames_[0].bodies[0].name, "Q1");
  EXPECT_EQ(source_.counts().wrong_frame, 0);
}

// The check that detects jumps of mocap poses also detects jumps of poses from ROS 2.
TEST_F(PoseSourceTest, MarksABodyThatJumpsAsOccluded) {
  for (int i = 0; i < 20; ++i, now_ += Duration{10'000}) {
    send("Q1", i == 15 ? 3.0 : 0.001 * i, Duration{0});
  }
  source_.on_time(moment());
  ASSERT_EQ(frames_.size(), 20U);
  EXPECT_TRUE(frames_[15].bodies[0].occluded);
  EXPECT_FALSE(frames_[16].bodies[0].occluded);
  EXPECT_EQ(source_.frame_counts().poses_outlying, 1);
}

}  // namespace
}  // namespace vantage::tools::ros2
