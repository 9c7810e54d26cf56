#include "drivers/vicon/frame_assembly.hpp"

#include <algorithm>
#include <span>

namespace vantage::drivers::vicon {

void FrameAssembly::clear() {
  is_open_ = false;
  is_first_ = true;
  frame_.clear();
  expected_size_ = 0;
}

SeenFrame& FrameAssembly::begin(Moment arrival) {
  if (is_open_) {
    pass_on();
  }
  frame_.clear();
  frame_.arrival = arrival;
  is_open_ = true;
  return frame_;
}

void FrameAssembly::pass_on_if_complete() {
  const auto expected = std::span(expected_).first(expected_size_);
  if (is_open_ && !is_first_ &&
      std::all_of(expected.begin(), expected.end(),
                  [this](const std::string& name) { return frame_.has(name); })) {
    pass_on();
  }
}

void FrameAssembly::on_time(Moment now) {
  if (is_open_ && now.steady >= frame_.arrival.steady + kPatience) {
    pass_on();
  }
}

std::optional<Duration> FrameAssembly::next_wake() const {
  return is_open_ ? std::optional(frame_.arrival.steady + kPatience) : std::nullopt;
}

void FrameAssembly::expect(std::string_view name) {
  if (expected_size_ == expected_.size()) {
    expected_.emplace_back();
  }
  expected_[expected_size_++] = name;
}

void FrameAssembly::expect_late(std::string_view name) {
  expect(name);
  SeenBody& late = frame_.add();
  late.name = name;
  late.pose_state = PoseState::kAbsent;
}

void FrameAssembly::pass_on() {
  is_open_ = false;
  is_first_ = false;
  expected_size_ = 0;
  for (const SeenBody& body : frame_.bodies()) {
    expect(body.name);
  }
  sink_(frame_);
}

}  // namespace vantage::drivers::vicon
