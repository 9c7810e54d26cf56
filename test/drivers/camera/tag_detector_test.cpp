#include "drivers/camera/tag_detector.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/camera/tag_pose.hpp"
#include "scenario/camera_spec.hpp"
#include "test/support/rendered_tags.hpp"

namespace vantage::drivers::camera {
namespace {

models::GrayImage image_of(int width, int height, int period, int low, int high,
                           std::mt19937_64& rng) {
  models::GrayImage out{width, height, {}};
  std::uniform_int_distribution<int> level(low, high);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const bool is_dark = period > 0 && ((row / period + column / period) % 2 == 0);
      out.pixels.push_back(static_cast<std::uint8_t>(is_dark ? 0 : level(rng)));
    }
  }
  return out;
}

TEST(TagDetector, SupportsEveryTagFamilyOfScenarios) {
  for (const char* family : scenario::kTagFamilies) {
    auto detector = make_tag_detector(family);
    if (!detector.ok() && detector.error().message.find("built without") != std::string::npos) {
      GTEST_SKIP() << detector.error().message;
    }
    ASSERT_TRUE(detector.ok()) << family;
    const sim::TagRenderer renderer(test::rendered_camera());
    std::mt19937_64 rng(1);
    sim::PlacedTag tag = test::lying_tag(0, {0.8, 0.0, 0.0}, 0.4);
    tag.pattern = sim::tag_pattern(family, 7).value();
    const auto image =
        renderer.render(test::looking_down(1.2, radians(60.0)), {tag}, sim::ImageQuality{}, rng);
    const std::vector<DetectedTag> found = detector.value()->detect(image);
    ASSERT_EQ(found.size(), 1U) << family;
    EXPECT_EQ(found[0].id, 7) << family;
    const auto truth =
        test::true_corners(test::rendered_camera(), test::looking_down(1.2, radians(60.0)), tag);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_LT((found[0].corners_pixels[i] - truth[i]).norm(), 0.7) << family << " corner " << i;
    }
  }
  EXPECT_FALSE(make_tag_detector("tag99h9").ok());
}

// For noise, checkerboards and uniform images of any size, the detector does not crash and all
// corners are finite. False detections are allowed.
TEST(TagDetector, SurvivesAnyImage) {
  auto detector = make_tag_detector("tag36h11");
  if (!detector.ok()) {
    GTEST_SKIP() << detector.error().message;
  }
  std::mt19937_64 rng(9);
  std::uniform_int_distribution<int> side(32, 200);
  for (int i = 0; i < 120; ++i) {
    const int high = i % 3 == 0 ? 0 : 255;
    const auto image = image_of(side(rng), side(rng), i % 13, i % 2 == 0 ? 0 : high, high, rng);
    for (const DetectedTag& tag : detector.value()->detect(image)) {
      for (const Eigen::Vector2d& corner : tag.corners_pixels) {
        EXPECT_TRUE(corner.allFinite());
      }
    }
  }
}

TEST(EstimatePoses, SurvivesAnyCorners) {
  std::mt19937_64 rng(10);
  std::uniform_real_distribution<double> pixel(-2000.0, 3000.0);
  const models::CameraModel camera = test::rendered_camera();
  for (int i = 0; i < 3000; ++i) {
    std::array<Eigen::Vector2d, 4> corners;
    for (Eigen::Vector2d& corner : corners) {
      corner = {pixel(rng), pixel(rng)};
      if (i % 5 == 0) {
        corner = corners[0];
      }
      if (i % 7 == 0) {
        corner *= std::pow(10.0, i % 40 - 20);
      }
    }
    if (const auto poses = estimate_poses(camera, 0.2, corners, 0.2)) {
      EXPECT_TRUE(poses->best.camera_from_tag.translation_m.allFinite());
      EXPECT_TRUE(poses->best.covariance.allFinite());
      EXPECT_GT(poses->best.camera_from_tag.translation_m.z(), 0.0);
    }
  }
}

}  // namespace
}  // namespace vantage::drivers::camera
