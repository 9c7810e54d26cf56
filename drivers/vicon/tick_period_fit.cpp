#include "drivers/vicon/tick_period_fit.hpp"

namespace vantage::drivers::vicon {
namespace {

double slope_s(const FrameMark& from, const FrameMark& to) {
  return (to.arrival_s - from.arrival_s) / static_cast<double>(to.tick - from.tick);
}

}  // namespace

void TickPeriodFit::add(const FrameMark& mark) {
  if (size_ > 0 && ++skipped_ < stride_) {
    return;
  }
  skipped_ = 0;
  if (size_ == kMarksMax) {
    for (std::size_t i = 0; 2 * i < kMarksMax; ++i) {
      marks_[i] = marks_[2 * i];
    }
    size_ = kMarksMax / 2;
    stride_ *= 2;
  }
  marks_[size_++] = mark;
}

double TickPeriodFit::span_s() const {
  return size_ == 0 ? 0.0 : marks_[size_ - 1].arrival_s - marks_[0].arrival_s;
}

std::optional<double> TickPeriodFit::tick_s() const {
  if (size_ < kMarksMin) {
    return std::nullopt;
  }
  // Andrew's monotone chain: the slopes of the hull increase.
  std::array<FrameMark, kMarksMax> hull{};
  std::size_t corners = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    while (corners >= 2 &&
           slope_s(hull[corners - 2], hull[corners - 1]) >= slope_s(hull[corners - 1], marks_[i])) {
      --corners;
    }
    hull[corners++] = marks_[i];
  }
  const std::int64_t middle = marks_[0].tick + (marks_[size_ - 1].tick - marks_[0].tick) / 2;
  std::size_t edge = 1;
  while (edge + 1 < corners && hull[edge].tick <= middle) {
    ++edge;
  }
  return slope_s(hull[edge - 1], hull[edge]);
}

}  // namespace vantage::drivers::vicon
