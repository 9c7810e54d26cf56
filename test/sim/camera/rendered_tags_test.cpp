#include "test/support/rendered_tags.hpp"

#include <cmath>
#include <optional>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "drivers/camera/tag_pose.hpp"

// Tags that the simulator renders and the detector finds: the chain from a pose to an image and
// back.

namespace vantage::sim {
namespace {

using drivers::camera::DetectedTag;

constexpr double kSigma_pixels = 0.1;
constexpr int kTag = 3;

class RenderedTags : public testing::Test {
 protected:
  void SetUp() override {
    if (!detector_.ok()) {
      GTEST_SKIP() << detector_.error().message;
    }
  }

  std::vector<DetectedTag> detect(const Pose3& world_from_camera,
                                  const std::vector<PlacedTag>& tags) {
    return detector_.value()->detect(renderer_.render(world_from_camera, tags, quality_, rng_));
  }
  /// Returns the error of a detected position in units of its covariance, eᵀ Σ⁻¹ e.
  std::optional<double> error_of(const DetectedTag& tag, const Pose3& world_from_camera,
                                 const PlacedTag& placed) const {
    const auto poses =
        drivers::camera::estimate_poses(camera_, placed.size_m, tag.corners_pixels, kSigma_pixels);
    const auto found = poses ? drivers::camera::position_of(*poses, kSigma_pixels)
                             : drivers::camera::PositionOrFault{};
    if (!found.position) {
      return std::nullopt;
    }
    const Eigen::Vector3d error =
        found.position->position_m -
        (inverse(world_from_camera) * placed.world_from_tag).translation_m;
    return error.dot(found.position->covariance_m2.ldlt().solve(error));
  }

  Result<std::unique_ptr<drivers::camera::TagDetector>> detector_ =
      drivers::camera::make_tag_detector("tag36h11");
  models::CameraModel camera_ = test::rendered_camera();
  TagRenderer renderer_{camera_};
  ImageQuality quality_;
  std::mt19937_64 rng_{11};
};

// The renderer and the detector agree on the corners, their order and the centre of a pixel: the
// mean error over all corners is far below a pixel, and each corner is within half a pixel.
TEST_F(RenderedTags, AreFoundWithTheirCorners) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Pose3 camera = test::looking_down(1.5, radians(50.0));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int corners = 0;
  for (int i = 0; i < 40; ++i) {
    const PlacedTag tag = test::lying_tag(
        kTag, {0.6 + 1.4 * share(rng_), 0.8 * share(rng_) - 0.4, 0.1}, 2.0 * kPi * share(rng_));
    const std::vector<DetectedTag> found = detect(camera, {tag});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].id, kTag);
    EXPECT_EQ(found[0].hamming, 0);
    const auto truth = test::true_corners(camera_, camera, tag);
    for (std::size_t corner = 0; corner < truth.size(); ++corner) {
      EXPECT_LT((found[0].corners_pixels[corner] - truth[corner]).norm(), 0.5);
      sum += found[0].corners_pixels[corner] - truth[corner];
      ++corners;
    }
  }
  EXPECT_LT((sum / corners).norm(), 0.03);
}

struct Statistics {
  int expected = 0;
  int found = 0;
  double mean_error = 0.0;  ///< mean of eᵀ Σ⁻¹ e; 3 for exact covariances
  double worst_error = 0.0;
};

// Positions are within their covariance. The expected mean is 3; the corners of rendered tags are
// more precise than kSigma_pixels except for large tags, so the mean is lower, but not far lower.
TEST_F(RenderedTags, AreLocatedWithinTheirCovariance) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Statistics all;
  for (int i = 0; i < 200; ++i) {
    const Pose3 camera = test::looking_down(1.0 + share(rng_), radians(50.0));
    const double range_m = 0.4 + 2.0 * share(rng_);
    const double bearing_rad = radians(70.0) * (share(rng_) - 0.5);
    const PlacedTag tag = test::lying_tag(
        kTag, {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0.15},
        2.0 * kPi * share(rng_));
    if (test::border_distance(camera_, test::true_corners(camera_, camera, tag)) < 8.0) {
      continue;
    }
    ++all.expected;
    const std::vector<DetectedTag> found = detect(camera, {tag});
    const auto error = found.size() == 1 ? error_of(found[0], camera, tag) : std::nullopt;
    if (error) {
      ++all.found;
      all.mean_error += *error;
      all.worst_error = std::max(all.worst_error, *error);
    }
  }
  EXPECT_GT(all.expected, 100);
  EXPECT_GE(all.found, all.expected * 98 / 100);
  EXPECT_GT(all.mean_error / all.found, 0.3);
  EXPECT_LT(all.mean_error / all.found, 3.0);
  EXPECT_LT(all.worst_error, 21.1);  // 99.99 % quantile of χ² with three degrees of freedom
}

// A tag is located if its white margin is in the image. A tag that is cut off has no position, or a
// correct one.
TEST_F(RenderedTags, AreLocatedUpToTheBorderOfTheImage) {
  const Pose3 camera = test::looking_down(1.2, radians(60.0));
  int inside = 0;
  int found_inside = 0;
  for (int i = 0; i < 60; ++i) {
    const PlacedTag tag = test::lying_tag(kTag, {0.75, 0.45 + 0.01 * i, 0.1}, 0.1 * i);
    const double distance =
        test::border_distance(camera_, test::true_corners(camera_, camera, tag));
    const std::vector<DetectedTag> found = detect(camera, {tag});
    const bool is_inside = distance > 0.125 * 70.0;  // the margin, an eighth of about 70 pixels
    inside += is_inside ? 1 : 0;
    ASSERT_LE(found.size(), 1U);
    const bool is_used =
        !found.empty() && drivers::camera::is_inside(camera_, found[0].corners_pixels);
    const auto error = is_used ? error_of(found[0], camera, tag) : std::nullopt;
    found_inside += is_inside && error ? 1 : 0;
    if (error) {
      EXPECT_LT(*error, 21.1) << distance << " pixels from the border";
    }
  }
  EXPECT_GT(inside, 10);
  EXPECT_LT(inside, 50);
  EXPECT_EQ(found_inside, inside);
}

// The plane of the tag is seen at 60° down to 15°.
TEST_F(RenderedTags, AreLocatedAtGrazingAngles) {
  for (double angle_deg = 60.0; angle_deg >= 15.0; angle_deg -= 3.0) {
    const double height_m = 1.4 * std::sin(radians(angle_deg));
    const double range_m = 1.4 * std::cos(radians(angle_deg));
    const Pose3 camera = test::looking_down(height_m, radians(angle_deg));
    const PlacedTag tag = test::lying_tag(kTag, {range_m, 0.1, 0.0}, angle_deg);
    const std::vector<DetectedTag> found = detect(camera, {tag});
    ASSERT_EQ(found.size(), 1U) << angle_deg;
    const auto error = error_of(found[0], camera, tag);
    ASSERT_TRUE(error) << angle_deg;
    EXPECT_LT(*error, 21.1) << angle_deg;
  }
}

// The nearer tag hides the middle of the farther one.
TEST_F(RenderedTags, HideFartherTags) {
  const Pose3 camera = test::looking_down(1.5, radians(60.0));
  const PlacedTag far = test::lying_tag(1, {0.8, 0.0, 0.0}, 0.0);
  const PlacedTag near = test::lying_tag(2, {0.8 * 2.0 / 3.0, 0.0, 0.5}, 0.0);
  const std::vector<DetectedTag> found = detect(camera, {near, far});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, 2);
}

TEST_F(RenderedTags, AreNotFoundFromBehind) {
  PlacedTag tag = test::lying_tag(kTag, {0.8, 0.0, 0.1}, 0.0);
  tag.world_from_tag.rotation = Quaternion(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(detect(test::looking_down(1.5, radians(60.0)), {tag}).empty());
}

TEST_F(RenderedTags, DependOnTheSeedOnly) {
  const Pose3 camera = test::looking_down(1.5, radians(60.0));
  const std::vector<PlacedTag> tags = {test::lying_tag(kTag, {0.8, 0.0, 0.1}, 0.3)};
  std::mt19937_64 first(5);
  std::mt19937_64 second(5);
  EXPECT_EQ(renderer_.render(camera, tags, quality_, first).pixels,
            renderer_.render(camera, tags, quality_, second).pixels);
}

TEST(TagPattern, RefusesUnknownTags) {
  EXPECT_FALSE(tag_pattern("tag36h11", 587).ok());
  EXPECT_FALSE(tag_pattern("tag36h11", -1).ok());
  EXPECT_FALSE(tag_pattern("tag99", 0).ok());
}

}  // namespace
}  // namespace vantage::sim
