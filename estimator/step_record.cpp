#include "estimator/step_record.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace vantage::estimator {

StepRecord::StepRecord(int target_count)
    : before(static_cast<std::size_t>(target_count)),
      heard(static_cast<std::size_t>(target_count)),
      heard_weight(static_cast<std::size_t>(target_count), 0.0),
      looks(kLooks) {
  for (Look& look : looks) {
    look.detections.reserve(static_cast<std::size_t>(target_count));
  }
}

void StepRecord::start(Time begin, Time end, const std::vector<Track>& tracks) {
  from = begin;
  to = end;
  before = tracks;
  std::fill(heard_weight.begin(), heard_weight.end(), 0.0);
  own_weight = 1.0;
  look_count = 0;
}

Look& StepRecord::insert(Time time) {
  if (look_count == static_cast<int>(looks.size())) {
    looks.emplace_back();
  }
  auto place = static_cast<std::size_t>(look_count++);
  while (place > 0 && looks[place - 1].time > time) {
    std::swap(looks[place], looks[place - 1]);
    --place;
  }
  Look& look = looks[place];
  look.time = time;
  look.detections.clear();
  look.counted = false;
  return look;
}

}  // namespace vantage::estimator
