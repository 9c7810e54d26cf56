#include "tools/doctor/camera_doctor.hpp"

#include <deque>
#include <string>

#include <gtest/gtest.h>

#include "test/support/rendered_tags.hpp"

namespace vantage::tools {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class Images : public drivers::camera::ImageSource {
 public:
  std::optional<drivers::camera::CapturedImage> next(Time /*now*/) override {
    if (waiting.empty()) {
      return std::nullopt;
    }
    auto out = waiting.front();
    waiting.pop_front();
    return out;
  }
  [[nodiscard]] drivers::camera::SourceCounts counts() const override { return {}; }
  [[nodiscard]] std::string status() const override { return "images of the test"; }

  std::deque<drivers::camera::CapturedImage> waiting;
};

class CameraDoctor : public testing::Test {
 protected:
  void SetUp() override {
    if (!detector_.ok()) {
      GTEST_SKIP() << detector_.error().message;
    }
    std::mt19937_64 rng(1);
    const sim::TagRenderer renderer(camera_);
    for (int i = 0; i < 3; ++i) {
      images_.waiting.push_back(
          {kStart + i * Duration{100'000},
           renderer.render(test::looking_down(1.2, radians(60.0)),
                           {test::lying_tag(5, {0.5, 0.1, 0.0}, 0.3)}, sim::ImageQuality{}, rng)});
    }
  }

  CameraObservation examine(const models::CameraModel& calibration) {
    CameraExamination examination;
    examination.size_m = test::kRenderedSize_m;
    examination.is_live = false;
    return examine_camera(
        images_, calibration, *detector_.value(), examination,
        [] { return kStart + Duration{300'000}; }, [] { return false; });
  }
  static std::string text_of(const models::CameraModel& calibration,
                             const CameraObservation& observed) {
    std::string out;
    for (const std::string& line : describe(calibration, observed, true)) {
      out += line + "\n";
    }
    return out;
  }

  models::CameraModel camera_ = test::rendered_camera();
  Result<std::unique_ptr<drivers::camera::TagDetector>> detector_ =
      drivers::camera::make_tag_detector("tag36h11");
  Images images_;
};

TEST_F(CameraDoctor, ReportsSizeRateStampsAndTags) {
  const CameraObservation observed = examine(camera_);
  EXPECT_EQ(observed.images, 3);
  EXPECT_NEAR(observed.rate_hz, 10.0, 1e-9);
  EXPECT_NEAR(observed.age_max_s, 0.3, 1e-9);
  ASSERT_EQ(observed.tags.size(), 1U);
  EXPECT_EQ(observed.tags.begin()->first, 5);
  EXPECT_EQ(observed.tags.begin()->second.images, 3);
  EXPECT_NEAR(observed.tags.begin()->second.distance_m, Eigen::Vector3d(0.5, 0.1, 1.2).norm(),
              0.01);
  EXPECT_TRUE(is_usable(observed));
  const std::string text = text_of(camera_, observed);
  for (const char* part : {"3 images of 640 x 480 pixels, 10.0 Hz", "mean 200.0 ms, at most 300.0",
                           "tag 5: in 3 images", "the calibration fits"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST_F(CameraDoctor, RefusesACalibrationOfAnotherSize) {
  models::CameraModel wrong = camera_;
  wrong.width = 1280;
  wrong.height = 960;
  const CameraObservation observed = examine(wrong);
  EXPECT_FALSE(is_usable(observed));
  EXPECT_NE(text_of(wrong, observed)
                .find("the images have 640 x 480 pixels, the calibration is "
                      "for 1280 x 960"),
            std::string::npos);
}

// With the wrong focal length fy, the corners of a tag do not fit any square.
TEST_F(CameraDoctor, RefusesACalibrationThatDoesNotFitTheTags) {
  models::CameraModel wrong = camera_;
  wrong.focal_y_pixels *= 1.5;
  wrong.distortion = {0.3, 0.0, 0.05, 0.05, 0.0};
  const CameraObservation observed = examine(wrong);
  EXPECT_FALSE(is_usable(observed));
  EXPECT_NE(text_of(wrong, observed).find("wrong calibration: the corners"), std::string::npos)
      << text_of(wrong, observed);
}

TEST_F(CameraDoctor, FindsNoImageUsableIfNoneArrives) {
  images_.waiting.clear();
  const CameraObservation observed = examine(camera_);
  EXPECT_FALSE(is_usable(observed));
  EXPECT_NE(text_of(camera_, observed).find("no image arrived"), std::string::npos);
}

TEST_F(CameraDoctor, ReportsTimesThatDoNotIncrease) {
  images_.waiting[2].time = kStart;
  EXPECT_FALSE(is_usable(examine(camera_)));
}

}  // namespace
}  // namespace vantage::tools
