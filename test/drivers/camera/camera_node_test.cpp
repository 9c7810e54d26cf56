#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/channels.hpp"
#include "drivers/camera/app/node.hpp"
#include "test/support/bus_pair.hpp"
#include "test/support/rendered_tags.hpp"

namespace vantage::drivers {
namespace {

// A multiple of the step τ = 0.5 s.
constexpr Time kStart = from_utime(1'700'000'000'000'000);

using camera::CapturedImage;
using camera::DetectedTag;

class Images : public camera::ImageSource {
 public:
  std::optional<CapturedImage> next(Time /*now*/) override {
    if (waiting.empty()) {
      return std::nullopt;
    }
    CapturedImage out = std::move(waiting.front());
    waiting.pop_front();
    return out;
  }
  [[nodiscard]] camera::SourceCounts counts() const override { return source_counts; }
  [[nodiscard]] std::string status() const override { return ""; }

  std::deque<CapturedImage> waiting;
  camera::SourceCounts source_counts;
};

/// Detector that finds the given tags in every image.
class FixedTags : public camera::TagDetector {
 public:
  std::vector<DetectedTag> detect(const models::GrayImage& /*image*/) override {
    ++images;
    return tags;
  }

  std::vector<DetectedTag> tags;
  int images = 0;
};

class CameraNodeTest : public testing::Test {
 protected:
  CameraNodeTest() {
    scenario_.robots.resize(1);
    scenario_.robots[0].name = "Q1";
    scenario_.robots[0].sensor.kind = models::SensorKind::kPosition;
    scenario_.targets = {{"R1", 0, {}, 0.2}};
    scenario_.planner.step_s = 0.5;
    scenario_.estimator.target_model.position_dim = 2;
    spec_.robot = "Q1";
    spec_.body_from_camera = test::looking_down(0.0, radians(60.0));
    spec_.tags = {{0, test::kRenderedSize_m, scenario::TagCarrier::kTarget, 0, "R1"}};
    auto source = std::make_unique<Images>();
    auto detector = std::make_unique<FixedTags>();
    images_ = source.get();
    detector_ = detector.get();
    DetectedTag tag;
    tag.margin = 80.0;
    tag.corners_pixels = test::true_corners(
        camera_, spec_.body_from_camera,
        {{}, test::kRenderedSize_m, Pose3{{0.8, 0.2, -1.4}, Quaternion::Identity()}});
    detector_->tags = {tag};
    node_ = std::make_unique<CameraNode>(buses_.own, clock_, scenario_, spec_, camera_,
                                         std::move(detector), std::move(source));
    buses_.other.subscribe<models::RobotMeasurement>(
        bus::measurement_channel("Q1"),
        [this](const models::RobotMeasurement& each) { measured_.push_back(each); });
  }

  void add_image(Duration after_start, int width = 640) {
    images_->waiting.push_back(
        {kStart + after_start,
         {width, 480, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * 480)}});
  }
  /// Publishes a frame: Q1 moves along x at 1 m/s, at a height of 1.5 m.
  void send_frame(Duration after_start) {
    clock_.set(kStart + after_start + Duration{5'000});
    models::MocapFrame frame;
    frame.stamp.time = kStart + after_start;
    frame.arrival = clock_.now();
    frame.frame_number = after_start.count() / 20'000;
    frame.bodies = {{"Q1", lift({to_seconds(after_start), 0.0, 0.0}, 1.5), false}};
    buses_.other.publish(bus::kVicon, frame);
    deliver();
  }
  void deliver() {
    buses_.own.handle(std::chrono::microseconds(0));
    buses_.other.handle(std::chrono::microseconds(0));
  }
  void tick(Duration after_start) {
    clock_.set(kStart + after_start);
    node_->tick(clock_.now());
    deliver();
  }
  std::int64_t count(const std::string& name) const {
    for (const models::NamedCount& counter : node_->counters()) {
      if (counter.name == "camera." + name) {
        return counter.count;
      }
    }
    return 0;
  }

  bus::VirtualClock clock_{kStart};
  test::BusPair buses_{11, 22};
  scenario::Scenario scenario_;
  scenario::CameraSpec spec_;
  models::CameraModel camera_ = test::rendered_camera();
  Images* images_ = nullptr;
  FixedTags* detector_ = nullptr;
  std::unique_ptr<CameraNode> node_;
  std::vector<models::RobotMeasurement> measured_;
};

// The image is processed after the robot has moved. The published viewpoint is the pose at the
// exposure.
TEST_F(CameraNodeTest, MeasuresFromThePoseOfTheExposure) {
  send_frame(Duration{0});
  add_image(Duration{10'000});
  tick(Duration{12'000});
  EXPECT_TRUE(measured_.empty()) << "no later frame has arrived";
  send_frame(Duration{20'000});
  ASSERT_EQ(measured_.size(), 1U);
  EXPECT_EQ(measured_[0].stamp.time, kStart + Duration{10'000});
  EXPECT_NEAR(measured_[0].viewpoint.world_from_body.x_m, 0.010, 1e-9);
  EXPECT_EQ(measured_[0].inputs.size(), 2U);
  ASSERT_EQ(measured_[0].detections.size(), 1U);
  EXPECT_EQ(measured_[0].detections[0].target_id, 0);
  EXPECT_NEAR(measured_[0].detections[0].measurement.z(0), 0.8, 1e-6);
  EXPECT_NEAR(measured_[0].detections[0].measurement.z(1), 0.2, 1e-6);
}

// Images at 25 Hz: one is processed in each period of 0.5 s.
TEST_F(CameraNodeTest, ProcessesOneImagePerPeriod) {
  for (int i = 0; i < 50; ++i) {
    const Duration at = i * Duration{40'000};
    send_frame(at);
    add_image(at);
    tick(at + Duration{1'000});
  }
  EXPECT_EQ(detector_->images, 4 + 1);
  EXPECT_EQ(measured_.size(), 4U + 1U);
}

TEST_F(CameraNodeTest, CountsImagesThatItCannotUse) {
  send_frame(Duration{2'000'000});
  add_image(Duration{900'000});         // 1.1 s old
  add_image(Duration{2'100'000});       // in the future
  add_image(Duration{2'000'000}, 320);  // size differs from the calibration
  add_image(Duration{2'000'000});
  add_image(Duration{2'000'000});  // same time as the previous image
  tick(Duration{2'005'000});
  EXPECT_EQ(count("images_late"), 1);
  EXPECT_EQ(count("images_early"), 1);
  EXPECT_EQ(count("images_of_wrong_size"), 1);
  EXPECT_EQ(count("images_out_of_order"), 1);
  EXPECT_EQ(measured_.size(), 1U);
}

TEST_F(CameraNodeTest, CountsImagesWithoutAPose) {
  send_frame(Duration{0});
  add_image(Duration{100'000});
  tick(Duration{110'000});
  tick(Duration{1'200'000});  // no frame for more than a second
  EXPECT_TRUE(measured_.empty());
  EXPECT_EQ(count("images_without_pose"), 1);
}

TEST_F(CameraNodeTest, PublishesNoDetectionWhileJammed) {
  models::AttackNotice attack;
  attack.stamp.time = kStart;
  attack.jammed = {"Q1"};
  buses_.other.publish(bus::kAttack, attack);
  deliver();
  add_image(Duration{0});
  send_frame(Duration{0});
  ASSERT_EQ(measured_.size(), 1U);
  EXPECT_TRUE(measured_[0].jammed);
  EXPECT_TRUE(measured_[0].detections.empty());
}

TEST_F(CameraNodeTest, ReportsTheCountsOfTheSource) {
  images_->source_counts = {1, 2, 3, 4};
  EXPECT_EQ(count("images_undecodable"), 1);
  EXPECT_EQ(count("images_unstamped"), 2);
  EXPECT_EQ(count("images_lost"), 3);
  EXPECT_EQ(count("interruptions"), 4);
}

}  // namespace
}  // namespace vantage::drivers
