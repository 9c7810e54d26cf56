#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/time.hpp"
#include "models/camera/image.hpp"
#include "scenario/camera_spec.hpp"

namespace vantage::drivers::camera {

/// Time between two attempts to open a source.
inline constexpr Duration kReopenPeriod = std::chrono::seconds(1);

struct CapturedImage {
  Time time{};  ///< middle of the exposure
  models::GrayImage image;
};

struct SourceCounts {
  std::int64_t undecodable = 0;    ///< files or images that are damaged or incomplete
  std::int64_t unstamped = 0;      ///< images without a usable time
  std::int64_t lost = 0;           ///< images that the device or the queue dropped
  std::int64_t interruptions = 0;  ///< how often the device or folder disappeared
};

/// Device or folder that delivers images.
class ImageSource {
 public:
  ImageSource() = default;
  virtual ~ImageSource() = default;
  ImageSource(const ImageSource&) = delete;
  ImageSource& operator=(const ImageSource&) = delete;
  ImageSource(ImageSource&&) = delete;
  ImageSource& operator=(ImageSource&&) = delete;

  /// Returns the next image that has arrived; nullopt if none is waiting. Tries once a second to
  /// open a source that is absent. `now`: time by the stack's clock.
  virtual std::optional<CapturedImage> next(Time now) = 0;
  [[nodiscard]] virtual SourceCounts counts() const = 0;
  /// Returns a sentence for the operator that describes the state of the source.
  [[nodiscard]] virtual std::string status() const = 0;
};

/// Returns the source of the scenario's camera: a V4L2 device, a folder, or the folder into which
/// vantage-camera-emulator writes.
std::unique_ptr<ImageSource> open_source(const scenario::CameraSpec& spec,
                                         const models::CameraModel& camera);

}  // namespace vantage::drivers::camera
