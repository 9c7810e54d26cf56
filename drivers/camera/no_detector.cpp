#include "drivers/camera/tag_detector.hpp"

namespace vantage::drivers::camera {

Result<std::unique_ptr<TagDetector>> make_tag_detector(const std::string& /*family*/) {
  return Error{
      "this program was built without the AprilTag library: install libapriltag-dev (or run "
      "tools/setup), then build again"};
}

}  // namespace vantage::drivers::camera
