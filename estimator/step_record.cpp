#include "estimator/step_record.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace vantage::estimator {

StepRecord::StepRecord(int target_count, int looks_max)
    : before(target_count),
      heard_of_start(target_count),
      heard(target_count),
      looks(static_cast<std::size_t>(looks_max)) {
  const std::size_t each = kDetectionsReserved / std::max<std::size_t>(1, looks.size());
  for (Look& look : looks) {
    look.detections.reserve(std::min(static_cast<std::size_t>(target_count), each));
  }
}

void StepRecord::start(Time begin, Time end, const TrackTable& tracks) {
  from = begin;
  to = end;
  before = tracks;
  heard_of_start.clear();
  heard.clear();
  heard_labels.clear();
  is_heard_of_end = false;
  look_count = 0;
}

bool StepRecord::holds(Time time, int looker) const {
  return std::any_of(looks.begin(), looks.begin() + look_count,
                     [&](const Look& look) { return look.time == time && look.looker == looker; });
}

Look& StepRecord::insert(Time time, int looker) {
  if (look_count == static_cast<int>(looks.size())) {
    looks.emplace_back();
  }
  auto place = static_cast<std::size_t>(look_count++);
  const auto is_after = [&](const Look& look) {
    return look.time > time || (look.time == time && look.looker > looker);
  };
  while (place > 0 && is_after(looks[place - 1])) {
    std::swap(looks[place], looks[place - 1]);
    --place;
  }
  Look& look = looks[place];
  look.time = time;
  look.looker = looker;
  look.detections.clear();
  look.counted = false;
  return look;
}

}  // namespace vantage::estimator
