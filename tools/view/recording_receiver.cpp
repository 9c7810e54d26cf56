#include "tools/view/recording_receiver.hpp"

namespace vantage::tools {

void RecordingReceiver::take(std::string video) {
  const std::lock_guard lock(mutex_);
  if (video_.empty() && failure_.empty()) {
    video_ = std::move(video);
  }
}

void RecordingReceiver::fail(std::string why) {
  const std::lock_guard lock(mutex_);
  if (video_.empty() && failure_.empty()) {
    failure_ = std::move(why);
  }
}

bool RecordingReceiver::is_over() const {
  const std::lock_guard lock(mutex_);
  return !video_.empty() || !failure_.empty();
}

std::string RecordingReceiver::video() const {
  const std::lock_guard lock(mutex_);
  return video_;
}

std::string RecordingReceiver::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace vantage::tools
