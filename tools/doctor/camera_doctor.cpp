#include "tools/doctor/camera_doctor.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "drivers/camera/tag_pose.hpp"

namespace vantage::tools {
namespace {

using drivers::camera::DetectedTag;

constexpr Duration kPoll{5'000};
constexpr double kSigma_pixels = 0.2;
// Pixels; larger root mean squares of the corners' errors show that the calibration is wrong. Noise
// gives about 0.2.
constexpr double kErrorMax_pixels = 1.0;
constexpr int kFreedom = 2;  // eight coordinates of the corners minus six of the pose

/// Returns the root mean square error of the corners per degree of freedom, pixels; 0 without tags.
double corner_error_pixels(const CameraObservation& observed) {
  double sum = 0.0;
  std::int64_t images = 0;
  for (const auto& [id, tag] : observed.tags) {
    sum += tag.error2_pixels2;
    images += tag.images;
  }
  return images > 0 ? std::sqrt(sum / static_cast<double>(kFreedom * images)) : 0.0;
}

void add_tags(const models::CameraModel& camera, double size_m,
              const std::vector<DetectedTag>& tags, CameraObservation& out) {
  for (const DetectedTag& each : tags) {
    const auto poses =
        drivers::camera::estimate_poses(camera, size_m, each.corners_pixels, kSigma_pixels);
    if (!poses || !drivers::camera::is_inside(camera, each.corners_pixels)) {
      continue;
    }
    ObservedTag& tag = out.tags[each.id];
    ++tag.images;
    tag.distance_m = poses->best.camera_from_tag.translation_m.norm();
    tag.error2_pixels2 += poses->best.error2_pixels2;
  }
}

}  // namespace

CameraObservation examine_camera(drivers::camera::ImageSource& source,
                                 const models::CameraModel& camera,
                                 drivers::camera::TagDetector& detector,
                                 const CameraExamination& examination,
                                 const std::function<Time()>& now,
                                 const std::function<bool()>& stop) {
  CameraObservation out;
  const Time end = now() + examination.listen;
  std::optional<Time> first;
  std::optional<Time> last;
  double age_sum_s = 0.0;
  while (!stop() && out.images < examination.images_max && now() < end) {
    const auto captured = source.next(now());
    if (!captured) {
      if (!examination.is_live) {
        break;
      }
      std::this_thread::sleep_for(kPoll);
      continue;
    }
    ++out.images;
    out.width = captured->image.width;
    out.height = captured->image.height;
    const double age_s = to_seconds(now() - captured->time);
    age_sum_s += age_s;
    out.age_max_s = std::max(out.age_max_s, age_s);
    out.stamps_not_increasing += last && captured->time <= *last ? 1 : 0;
    first = first ? first : captured->time;
    last = captured->time;
    if (out.width != camera.width || out.height != camera.height) {
      ++out.wrong_size;
      continue;
    }
    add_tags(camera, examination.size_m, detector.detect(captured->image), out);
  }
  if (out.images > 1 && *last > *first) {
    out.rate_hz = static_cast<double>(out.images - 1) / to_seconds(*last - *first);
  }
  out.age_mean_s = out.images > 0 ? age_sum_s / static_cast<double>(out.images) : 0.0;
  out.counts = source.counts();
  out.status = source.status();
  return out;
}

bool is_usable(const CameraObservation& observed) {
  return observed.images > 0 && observed.wrong_size == 0 && observed.stamps_not_increasing == 0 &&
         corner_error_pixels(observed) <= kErrorMax_pixels;
}

std::vector<std::string> describe(const models::CameraModel& camera,
                                  const CameraObservation& observed, bool is_live) {
  std::vector<std::string> out{observed.status};
  if (observed.images == 0) {
    out.emplace_back("no image arrived");
  } else {
    out.push_back(fmt::format("{} images of {} x {} pixels, {:.1f} Hz", observed.images,
                              observed.width, observed.height, observed.rate_hz));
    if (is_live) {
      out.push_back(
          fmt::format("age at arrival, from the middle of the exposure: mean {:.1f} ms, at most "
                      "{:.1f} ms",
                      1e3 * observed.age_mean_s, 1e3 * observed.age_max_s));
    }
  }
  for (const auto& [id, tag] : observed.tags) {
    out.push_back(
        fmt::format("    tag {}: in {} images, last at {:.2f} m", id, tag.images, tag.distance_m));
  }
  if (observed.images > 0 && observed.tags.empty()) {
    out.emplace_back(
        "no tag was detected: check family, light, focus and the white margin of a tag");
  }
  const auto count = [&](std::int64_t number, const char* what) {
    if (number > 0) {
      out.push_back(fmt::format("{} {}", number, what));
    }
  };
  count(observed.counts.undecodable, "files or images are damaged or truncated");
  count(observed.counts.unstamped, "images have no usable time");
  count(observed.counts.lost, "images were lost");
  count(observed.counts.interruptions, "times the camera or folder disappeared");
  if (observed.wrong_size > 0) {
    out.push_back(fmt::format(
        "wrong calibration: the images have {} x {} pixels, the calibration is for {} x {}; "
        "calibrate at the size of the images",
        observed.width, observed.height, camera.width, camera.height));
  }
  if (observed.stamps_not_increasing > 0) {
    out.push_back(fmt::format("{} images are not later than the one before: the times are wrong",
                              observed.stamps_not_increasing));
  }
  if (const double error = corner_error_pixels(observed); error > kErrorMax_pixels) {
    out.push_back(fmt::format(
        "wrong calibration: the corners of the tags are {:.1f} pixels from those of squares; at "
        "most {:.1f} is normal. Calibrate this camera and lens again",
        error, kErrorMax_pixels));
  } else if (!observed.tags.empty()) {
    out.push_back(
        fmt::format("the calibration fits: the corners are {:.2f} pixels from those of "
                    "squares",
                    error));
  }
  return out;
}

}  // namespace vantage::tools
