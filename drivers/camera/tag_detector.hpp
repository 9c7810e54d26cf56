#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.hpp"
#include "models/camera/image.hpp"

namespace vantage::drivers::camera {

/// Corners of a tag in its own frame, in units of half its side: x right, y up, z out of the tag.
inline const std::array<Eigen::Vector2d, 4> kTagCorners = {
    Eigen::Vector2d(-1.0, -1.0), Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(1.0, 1.0),
    Eigen::Vector2d(-1.0, 1.0)};

/// Tag in an image.
struct DetectedTag {
  int id = 0;
  int hamming = 0;      ///< number of corrected bits
  double margin = 0.0;  ///< mean difference of the bits from the threshold, 0 to 255
  std::array<Eigen::Vector2d, 4> corners_pixels;  ///< in the order of kTagCorners
};

/// Detector of the tags of one family. It allocates memory, so it must not run in a control loop.
class TagDetector {
 public:
  TagDetector() = default;
  virtual ~TagDetector() = default;
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;
  TagDetector(TagDetector&&) = delete;
  TagDetector& operator=(TagDetector&&) = delete;

  /// Returns the tags in `image`, by ascending id. The centre of the first pixel is (0, 0).
  [[nodiscard]] virtual std::vector<DetectedTag> detect(const models::GrayImage& image) = 0;
};

/// Returns a detector for one of scenario::kTagFamilies; an error if the program was built without
/// the AprilTag library.
Result<std::unique_ptr<TagDetector>> make_tag_detector(const std::string& family);

}  // namespace vantage::drivers::camera
