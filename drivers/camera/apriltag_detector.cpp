#include <algorithm>
#include <cstdint>
#include <cstring>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>

#include "drivers/camera/tag_detector.hpp"

namespace vantage::drivers::camera {
namespace {

struct FamilyRow {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyRow kFamilies[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy}};

/// Offset of the library's coordinates, in which the corner of the first pixel is (0, 0).
constexpr double kPixelCenter = 0.5;
constexpr int kBitsCorrected = 2;
/// Smallest contrast between the black and the white of a tag, in grey levels of 255. The library's
/// default, 5, finds edges in the noise of most cameras and takes ten times longer.
constexpr int kContrastMin = 30;

class AprilTagDetector : public TagDetector {
 public:
  explicit AprilTagDetector(const FamilyRow& row)
      : row_(row), family_(row.create()), detector_(apriltag_detector_create()) {
    detector_->nthreads = 1;
    detector_->quad_decimate = 1.0F;
    detector_->qtp.min_white_black_diff = kContrastMin;
    apriltag_detector_add_family_bits(detector_, family_, kBitsCorrected);
  }
  ~AprilTagDetector() override {
    apriltag_detector_destroy(detector_);
    row_.destroy(family_);
  }
  AprilTagDetector(const AprilTagDetector&) = delete;
  AprilTagDetector& operator=(const AprilTagDetector&) = delete;
  AprilTagDetector(AprilTagDetector&&) = delete;
  AprilTagDetector& operator=(AprilTagDetector&&) = delete;

  std::vector<DetectedTag> detect(const models::GrayImage& image) override {
    constexpr int kAlignment = 96;  // bytes; alignment of the library's own images
    const int stride = (image.width + kAlignment - 1) / kAlignment * kAlignment;
    padded_.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(image.height), 0);
    for (int row = 0; row < image.height; ++row) {
      std::memcpy(padded_.data() + static_cast<std::ptrdiff_t>(row) * stride,
                  image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width,
                  static_cast<std::size_t>(image.width));
    }
    image_u8_t input{image.width, image.height, stride, padded_.data()};
    zarray_t* const found = apriltag_detector_detect(detector_, &input);
    std::vector<DetectedTag> out;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* each = nullptr;
      zarray_get(found, i, &each);
      DetectedTag tag;
      tag.id = each->id;
      tag.hamming = each->hamming;
      tag.margin = static_cast<double>(each->decision_margin);
      for (std::size_t corner = 0; corner < tag.corners_pixels.size(); ++corner) {
        tag.corners_pixels[corner] = {each->p[corner][0] - kPixelCenter,
                                      each->p[corner][1] - kPixelCenter};
      }
      out.push_back(tag);
    }
    apriltag_detections_destroy(found);
    std::stable_sort(out.begin(), out.end(),
                     [](const DetectedTag& a, const DetectedTag& b) { return a.id < b.id; });
    return out;
  }

 private:
  const FamilyRow& row_;
  apriltag_family_t* family_;
  apriltag_detector_t* detector_;
  std::vector<std::uint8_t> padded_;  ///< copy of the image with padded rows
};

}  // namespace

Result<std::unique_ptr<TagDetector>> make_tag_detector(const std::string& family) {
  for (const FamilyRow& row : kFamilies) {
    if (family == row.name) {
      return std::unique_ptr<TagDetector>(std::make_unique<AprilTagDetector>(row));
    }
  }
  return Error{"unknown tag family '" + family +
               "'; the families are tag36h11, tag25h9, tag16h5 and tagStandard41h12"};
}

}  // namespace vantage::drivers::camera
