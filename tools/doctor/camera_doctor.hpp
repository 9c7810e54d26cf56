#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/camera/image_source.hpp"
#include "drivers/camera/tag_detector.hpp"
#include "models/camera/camera_model.hpp"

namespace vantage::tools {

/// Tag in the images of a camera.
struct ObservedTag {
  std::int64_t images = 0;      ///< images with the tag
  double distance_m = 0.0;      ///< m; distance from the camera in the last image
  double error2_pixels2 = 0.0;  ///< sum of the squared errors of the corners over all images
};

/// Result of receiving images.
struct CameraObservation {
  std::int64_t images = 0;
  std::int64_t wrong_size = 0;  ///< images of another size than the calibration
  int width = 0;                ///< pixels, of the last image
  int height = 0;
  double rate_hz = 0.0;     ///< Hz; from the times of the exposures
  double age_mean_s = 0.0;  ///< s; arrival minus middle of the exposure
  double age_max_s = 0.0;
  std::int64_t stamps_not_increasing = 0;
  std::map<int, ObservedTag> tags;
  drivers::camera::SourceCounts counts;
  std::string status;  ///< status text of the source
};

/// Settings of an examination.
struct CameraExamination {
  double size_m = 0.16;  ///< m; side of the black square of all tags
  Duration listen{2'000'000};
  std::int64_t images_max = 1000;
  /// false: stored images; their ages are meaningless, and the examination ends after the last one
  bool is_live = true;
};

/// Receives the images of `source` and detects tags in them, until the time `listen` has passed.
/// After `stop` it returns within 10 ms.
CameraObservation examine_camera(drivers::camera::ImageSource& source,
                                 const models::CameraModel& camera,
                                 drivers::camera::TagDetector& detector,
                                 const CameraExamination& examination,
                                 const std::function<Time()>& now,
                                 const std::function<bool()>& stop);

/// Returns the findings as text, then the remedies.
std::vector<std::string> describe(const models::CameraModel& camera,
                                  const CameraObservation& observed, bool is_live);

/// True if images arrived, their times increase, and the calibration fits them.
bool is_usable(const CameraObservation& observed);

}  // namespace vantage::tools
