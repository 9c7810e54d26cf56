#include "tools/ros2/detection_source.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "test/tools/ros2/ros2_messages.hpp"

namespace vantage::tools::ros2 {
namespace {

constexpr Time kTime = from_utime(1'700'000'000'000'000);
constexpr Duration kHalfFrame{10'000};

scenario::Scenario one_robot() {
  scenario::Scenario out;
  out.robots.resize(1);
  out.robots[0].name = "Q1";
  out.robots[0].sensor_publisher = scenario::Publisher::kExternal;
  out.targets = {{"R1", 0, {}, 0.2}, {"R2", 1, {}, 0.2}};
  return out;
}

std::shared_ptr<const models::MocapFrame> frame_at(Time time, double x_m) {
  auto frame = std::make_shared<models::MocapFrame>();
  frame->stamp.time = time;
  frame->bodies = {{"Q1", lift({x_m, 1.0, kPi / 2}, 2.0), false}};
  return frame;
}

class DetectionSourceTest : public testing::Test {
 protected:
  std::optional<models::RobotMeasurement> seen(const std::string& message) {
    source_.on_message(test::bytes_of(message), kTime + kHalfFrame);
    EXPECT_FALSE(source_.next(kTime + kHalfFrame)) << "no later frame has arrived";
    source_.on_frame(frame_at(kTime + 2 * kHalfFrame, 0.2));
    return source_.next(kTime + 2 * kHalfFrame);
  }

  scenario::Scenario scenario_ = one_robot();
  DetectionSource source_{scenario_, "Q1", "world"};
};

// A message in the world frame or in the robot's frame gives the measurement of the sensor model.
TEST_F(DetectionSourceTest, GivesTheMeasurementOfTheSensorModel) {
  const models::Viewpoint viewpoint{{0.1, 1.0, kPi / 2}, 2.0};  // between both mocap frames
  const Eigen::Vector3d target_m(1.0, 3.0, 0.0);
  const Eigen::Vector3d in_body = inverse(lift(viewpoint.world_from_body, 2.0)) * target_m;
  for (const bool is_world : {true, false}) {
    source_ = DetectionSource(scenario_, "Q1", "world");
    source_.on_frame(frame_at(kTime, 0.0));
    const auto made =
        seen(test::detections_message(kTime + kHalfFrame, is_world ? "world" : "Q1",
                                      {{"1", "rover", is_world ? target_m : in_body, 0.0}}));
    ASSERT_TRUE(made);
    EXPECT_EQ(made->robot, "Q1");
    EXPECT_EQ(made->stamp.time, kTime + kHalfFrame);
    EXPECT_NEAR(made->viewpoint.world_from_body.x_m, 0.1, 1e-12);
    EXPECT_EQ(made->inputs.size(), 2U);
    ASSERT_EQ(made->detections.size(), 1U);
    EXPECT_EQ(made->detections[0].target_id, 1);
    const auto& sensor = scenario_.robots[0].sensor;
    const models::PositionVector position_m = target_m.head<2>();
    EXPECT_TRUE(made->detections[0].measurement.z.isApprox(
        models::observe(sensor, viewpoint, position_m), 1e-9));
    EXPECT_TRUE(made->detections[0].measurement.V.isApprox(
        models::noise_covariance(sensor, viewpoint, position_m), 1e-9));
  }
}

// An isotropic position error of variance s² gives s² along the range and s²/r² in bearing.
TEST_F(DetectionSourceTest, ConvertsTheStatedCovariance) {
  source_.on_frame(frame_at(kTime, 0.0));
  const auto made = seen(
      test::detections_message(kTime + kHalfFrame, "world", {{"", "R1", {0.1, 3.0, 0.0}, 0.04}}));
  ASSERT_TRUE(made && made->detections.size() == 1);
  const models::MeasurementMatrix& V = made->detections[0].measurement.V;
  EXPECT_NEAR(V(0, 0), 0.04, 1e-6);
  EXPECT_NEAR(V(1, 1), 0.04 / 4.0, 1e-6);
  EXPECT_NEAR(V(0, 1), 0.0, 1e-9);
}

TEST_F(DetectionSourceTest, CountsUnusableMessages) {
  source_.on_frame(frame_at(kTime, 0.0));
  const auto made = seen(test::detections_message(
      kTime + kHalfFrame, "world",
      {{"7", "chair", {1.0, 3.0, 0.0}, 0.0}, {"0", "", {500.0, 0.0, 0.0}, 0.0}}));
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->detections.empty());
  EXPECT_EQ(source_.counts().unknown_target, 1);
  EXPECT_EQ(source_.counts().out_of_view, 1);
  const Time now = kTime + 2 * kHalfFrame;
  source_.on_message({}, now);
  source_.on_message(test::bytes_of(test::detections_message(now, "map", {})), now);
  source_.on_message(
      test::bytes_of(test::detections_message(now - 2 * DetectionSource::kAgeMax, "world", {})),
      now);
  source_.on_message(
      test::bytes_of(test::detections_message(now + 2 * DetectionSource::kEarlyMax, "world", {})),
      now);
  EXPECT_FALSE(source_.next(now));
  EXPECT_EQ(source_.counts().unreadable, 1);
  EXPECT_EQ(source_.counts().wrong_frame, 1);
  EXPECT_EQ(source_.counts().stale, 1);
  EXPECT_EQ(source_.counts().early, 1);
}

TEST_F(DetectionSourceTest, DropsAMessageWithoutAPoseAtItsTime) {
  source_.on_message(test::bytes_of(test::detections_message(kTime, "world", {})), kTime);
  source_.on_frame(frame_at(kTime + kHalfFrame, 0.0));  // no earlier frame
  EXPECT_FALSE(source_.next(kTime + kHalfFrame));
  EXPECT_EQ(source_.counts().without_pose, 1);
}

TEST_F(DetectionSourceTest, HidesIdsIfTheSensorDetectsNone) {
  scenario_.robots[0].detection.detects_ids = false;
  source_ = DetectionSource(scenario_, "Q1", "world");
  source_.on_frame(frame_at(kTime, 0.0));
  const auto made = seen(
      test::detections_message(kTime + kHalfFrame, "world", {{"1", "", {0.1, 3.0, 0.0}, 0.0}}));
  ASSERT_TRUE(made && made->detections.size() == 1);
  EXPECT_EQ(made->detections[0].target_id, models::kNoTargetId);
}

}  // namespace
}  // namespace vantage::tools::ros2
