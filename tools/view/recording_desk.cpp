#include "tools/view/recording_desk.hpp"

namespace vantage::tools {

void RecordingDesk::take(std::string video) {
  const std::lock_guard lock(mutex_);
  if (video_.empty() && failure_.empty()) {
    video_ = std::move(video);
  }
}

void RecordingDesk::fail(std::string why) {
  const std::lock_guard lock(mutex_);
  if (video_.empty() && failure_.empty()) {
    failure_ = std::move(why);
  }
}

bool RecordingDesk::is_over() const {
  const std::lock_guard lock(mutex_);
  return !video_.empty() || !failure_.empty();
}

std::string RecordingDesk::video() const {
  const std::lock_guard lock(mutex_);
  return video_;
}

std::string RecordingDesk::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace vantage::tools
