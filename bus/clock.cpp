#include "bus/clock.hpp"

namespace vantage::bus {

Time SystemClock::now() const {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return Time{std::chrono::duration_cast<Duration>(since_epoch)};
}

}  // namespace vantage::bus
