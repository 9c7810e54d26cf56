#include "core/check.hpp"
#include "tools/ros2/port.hpp"

namespace vantage::tools::ros2 {

std::unique_ptr<Port> open_port(const scenario::Ros2Spec& /*spec*/) {
  throw StartupError(
      "vantage ros2: this program was built without DDS; install cyclonedds-dev (tools/setup), "
      "then configure and build again");
}

}  // namespace vantage::tools::ros2
