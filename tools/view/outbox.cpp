#include "tools/view/outbox.hpp"

#include <algorithm>
#include <utility>

namespace vantage::tools {

void Outbox::push(Frame frame) {
  bytes_ += frame.size();
  switch (frame.kind) {
    case Frame::Kind::kControl:
      ++control_waiting_;
      break;
    case Frame::Kind::kState: {
      const auto outdated = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& waiting) {
        return waiting.kind == Frame::Kind::kState &&
               waiting.subscription_id == frame.subscription_id;
      });
      if (outdated != frames_.end()) {
        bytes_ -= outdated->size();
        frames_.erase(outdated);
      }
      break;
    }
    case Frame::Kind::kFlow:
      flow_bytes_ += frame.size();
      break;
  }
  frames_.push_back(std::move(frame));
  make_room();
}

void Outbox::make_room() {
  auto oldest = frames_.begin();
  while (flow_bytes_ > bytes_max_ && oldest + 1 < frames_.end()) {
    if (oldest->kind == Frame::Kind::kFlow) {
      bytes_ -= oldest->size();
      flow_bytes_ -= oldest->size();
      ++dropped_;
      oldest = frames_.erase(oldest);
    } else {
      ++oldest;
    }
  }
}

std::optional<Frame> Outbox::pop() {
  if (frames_.empty()) {
    return std::nullopt;
  }
  Frame frame = std::move(frames_.front());
  frames_.pop_front();
  bytes_ -= frame.size();
  if (frame.kind == Frame::Kind::kFlow) {
    flow_bytes_ -= frame.size();
  } else if (frame.kind == Frame::Kind::kControl) {
    --control_waiting_;
  }
  return frame;
}

}  // namespace vantage::tools
