#include "core/processor_wait.hpp"

namespace vantage {

void ProcessorWait::add(Time now, std::int64_t waited_us) {
  if (count_ > 0) {
    const Reading& newest = at(count_ - 1);
    if (now <= newest.time || waited_us < newest.waited_us) {
      count_ = 0;
    }
  }
  if (count_ == kReadingsMax) {
    first_ = (first_ + 1) % kReadingsMax;
    --count_;
  }
  readings_[(first_ + count_) % kReadingsMax] = {now, waited_us};
  ++count_;
  while (count_ > 1 && now - at(1).time >= kWindow) {
    first_ = (first_ + 1) % kReadingsMax;
    --count_;
  }
}

double ProcessorWait::recent_s() const {
  return count_ < 2 ? 0.0 : 1e-6 * static_cast<double>(at(count_ - 1).waited_us - at(0).waited_us);
}

}  // namespace vantage
