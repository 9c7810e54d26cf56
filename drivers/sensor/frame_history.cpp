#include "drivers/sensor/frame_history.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "drivers/sensor/pose_sensor.hpp"

namespace vantage::drivers {
namespace {

constexpr const char* kMocapChannel = "VICON";

}  // namespace

void FrameHistory::add(std::shared_ptr<const models::MocapFrame> frame) {
  if (!frames_.empty() && frame->stamp.time <= frames_.back()->stamp.time) {
    frames_.clear();
  }
  frames_.push_back(std::move(frame));
  while (frames_.back()->stamp.time - frames_.front()->stamp.time > age_max_ + kGapMax) {
    frames_.pop_front();
  }
}

bool FrameHistory::reaches(Time time) const {
  return !frames_.empty() && frames_.back()->stamp.time >= time;
}

std::optional<FrameHistory::Found> FrameHistory::at(Time time) const {
  const auto after = std::find_if(frames_.begin(), frames_.end(),
                                  [&](const auto& frame) { return frame->stamp.time >= time; });
  if (after == frames_.end()) {
    return std::nullopt;
  }
  const bool is_exact = (*after)->stamp.time == time;
  if (!is_exact && (after == frames_.begin() ||
                    (*after)->stamp.time - (*std::prev(after))->stamp.time > kGapMax)) {
    return std::nullopt;
  }
  const models::MocapFrame& before = is_exact ? **after : **std::prev(after);
  Found out{interpolate(before, **after, time), {}};
  if (!is_exact) {
    out.inputs.push_back(models::ref_to(kMocapChannel, before.stamp));
  }
  out.inputs.push_back(models::ref_to(kMocapChannel, (*after)->stamp));
  return out;
}

}  // namespace vantage::drivers
