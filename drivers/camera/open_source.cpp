#include <string_view>

#include "drivers/camera/folder_source.hpp"
#include "drivers/camera/image_source.hpp"
#include "drivers/camera/v4l2_source.hpp"

namespace vantage::drivers::camera {

std::unique_ptr<ImageSource> open_source(const scenario::CameraSpec& spec,
                                         const models::CameraModel& camera) {
  const std::string_view source = spec.source;
  const std::string_view folder = scenario::kFolderSource;
  const std::string_view device = scenario::kV4l2Source;
  if (source.starts_with(folder)) {
    return std::make_unique<FolderSource>(spec.source.substr(folder.size()));
  }
  if (source.starts_with(device)) {
    return std::make_unique<V4l2Source>(spec.source.substr(device.size()), camera, spec);
  }
  return std::make_unique<FolderSource>(spec.simulated_folder);
}

}  // namespace vantage::drivers::camera
