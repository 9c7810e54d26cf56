#include "sim/camera/tag_pattern.hpp"

namespace vantage::sim {

Result<TagPattern> tag_pattern(const std::string& /*family*/, int /*id*/) {
  return Error{
      "this program was built without the AprilTag library: install libapriltag-dev (or run "
      "tools/setup), then build again"};
}

}  // namespace vantage::sim
