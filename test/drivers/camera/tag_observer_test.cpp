#include "drivers/camera/tag_observer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "test/support/rendered_tags.hpp"

namespace vantage::drivers::camera {
namespace {

constexpr Time kTime = from_utime(1'700'000'000'000'000);

class TagObserverTest : public testing::Test {
 protected:
  TagObserverTest() {
    spec_.robot = "Q1";
    spec_.body_from_camera = test::looking_down(-0.1, radians(60.0));
    spec_.attitude_sigma_rad = 0.0;
    spec_.tags = {{0, test::kRenderedSize_m, scenario::TagCarrier::kTarget, 4, "R5"},
                  {1, test::kRenderedSize_m, scenario::TagCarrier::kLandmark, 6, ""},
                  {2, test::kRenderedSize_m, scenario::TagCarrier::kRobot, 12, "Q2"}};
    sensor_.kind = models::SensorKind::kPosition;
    sensor_.range_max_m = 3.0;
  }

  /// Returns the tag with exact corners at a point in the body's frame.
  [[nodiscard]] DetectedTag tag_at(int id, const Eigen::Vector3d& at_body_m) const {
    DetectedTag out;
    out.id = id;
    out.margin = 80.0;
    const sim::PlacedTag placed{
        {}, test::kRenderedSize_m, Pose3{at_body_m, Quaternion::Identity()}};
    out.corners_pixels = test::true_corners(camera_, spec_.body_from_camera, placed);
    return out;
  }
  [[nodiscard]] TagObserver observer() const { return {spec_, camera_, sensor_, 2}; }

  models::CameraModel camera_ = test::rendered_camera();
  scenario::CameraSpec spec_;
  models::SensorModel sensor_;
};

TEST_F(TagObserverTest, LocatesTagsInTheBodyFrame) {
  const Eigen::Vector3d at_m(0.9, 0.3, -1.2);
  TagObserver observer = this->observer();
  const std::vector<SeenTag> seen = observer.observe({tag_at(0, at_m)});
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_NEAR((seen[0].position_body_m - at_m).norm(), 0.0, 1e-6);
  EXPECT_NEAR(seen[0].range_m, std::hypot(0.9, 0.3), 1e-6);
  EXPECT_NEAR(seen[0].bearing_rad, std::atan2(0.3, 0.9), 1e-6);
  EXPECT_GT(seen[0].range_variance_m2, 0.0);
  EXPECT_GT(seen[0].bearing_variance_rad2, 0.0);
}

// An attitude error of 0.01 rad moves a tag at a distance d by 0.01 d across the line of sight.
TEST_F(TagObserverTest, AddsTheErrorOfTheAttitude) {
  const DetectedTag tag = tag_at(0, {0.9, 0.0, -1.2});
  TagObserver exact = observer();
  spec_.attitude_sigma_rad = 0.01;
  TagObserver rough = observer();
  const SeenTag with = rough.observe({tag})[0];
  const Eigen::Matrix3d added =
      with.covariance_body_m2 - exact.observe({tag})[0].covariance_body_m2;
  const Eigen::Vector3d from_camera = with.position_body_m - spec_.body_from_camera.translation_m;
  EXPECT_NEAR(added.trace(), 2.0 * 1e-4 * from_camera.squaredNorm(), 1e-12);
  EXPECT_NEAR((added * from_camera).norm(), 0.0, 1e-12);
}

TEST_F(TagObserverTest, MeasuresTargetsAndReportsSightingsOfOtherBodies) {
  TagObserver observer = this->observer();
  const std::vector<SeenTag> seen = observer.observe(
      {tag_at(0, {0.9, 0.3, -1.2}), tag_at(1, {1.2, -0.2, -1.2}), tag_at(2, {0.8, -0.4, -1.0})});
  ASSERT_EQ(seen.size(), 3U);
  models::RobotMeasurement made;
  const Pose3 world_from_body = lift({1.0, -0.5, kPi / 2}, 1.5);
  made.viewpoint = {flatten(world_from_body), 1.5};
  observer.add_targets(seen, world_from_body, made);
  ASSERT_EQ(made.detections.size(), 1U);
  EXPECT_EQ(made.detections[0].target_id, 4);
  EXPECT_NEAR(made.detections[0].measurement.z(0), 0.9, 1e-6);
  EXPECT_NEAR(made.detections[0].measurement.z(1), 0.3, 1e-6);
  const std::vector<models::Sighting> sightings = TagObserver::sightings(seen, kTime);
  ASSERT_EQ(sightings.size(), 2U);
  EXPECT_EQ(sightings[0].id, 6);
  EXPECT_NEAR(sightings[0].range_m, std::hypot(1.2, 0.2), 1e-6);
  EXPECT_EQ(sightings[1].id, 12);
  EXPECT_NEAR(sightings[1].bearing_rad, std::atan2(-0.4, 0.8), 1e-6);
}

TEST_F(TagObserverTest, DropsAndCountsWrongTags) {
  TagObserver observer = this->observer();
  const Eigen::Vector3d at_m(0.9, 0.3, -1.2);
  DetectedTag misread = tag_at(0, at_m);
  misread.hamming = 2;
  EXPECT_TRUE(observer.observe({misread}).empty());
  DetectedTag pale = tag_at(0, at_m);
  pale.margin = 3.0;
  EXPECT_TRUE(observer.observe({pale}).empty());
  EXPECT_EQ(observer.counts().misread, 2);
  EXPECT_TRUE(observer.observe({tag_at(77, at_m)}).empty());
  EXPECT_EQ(observer.counts().unknown, 1);
  EXPECT_TRUE(observer.observe({tag_at(0, at_m), tag_at(0, {1.2, 0.0, -1.2})}).empty());
  EXPECT_EQ(observer.counts().duplicate, 2);
  DetectedTag bent = tag_at(0, at_m);
  bent.corners_pixels[1] += Eigen::Vector2d(8.0, 8.0);
  EXPECT_TRUE(observer.observe({bent}).empty());
  EXPECT_EQ(observer.counts().bad_fit, 1);
  DetectedTag cut = tag_at(0, at_m);
  for (Eigen::Vector2d& corner : cut.corners_pixels) {
    corner.x() += 638.0 - tag_at(0, at_m).corners_pixels[1].x();
  }
  EXPECT_TRUE(observer.observe({cut}).empty());
  EXPECT_EQ(observer.counts().at_border, 1);
}

TEST_F(TagObserverTest, CountsTargetsOutsideTheSensorsView) {
  sensor_.range_max_m = 0.5;
  TagObserver observer = this->observer();
  models::RobotMeasurement made;
  made.viewpoint.height_m = 1.5;
  observer.add_targets(observer.observe({tag_at(0, {0.9, 0.3, -1.2})}), lift({}, 1.5), made);
  EXPECT_TRUE(made.detections.empty());
  EXPECT_EQ(observer.counts().out_of_view, 1);
}

}  // namespace
}  // namespace vantage::drivers::camera
