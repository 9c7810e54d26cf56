#include "estimator/filter/step_record.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace vantage::estimator {

StepRecord::StepRecord(int target_count, int observations_max)
    : before(target_count),
      received_at_start(target_count),
      received_at_end(target_count),
      observations(static_cast<std::size_t>(observations_max)) {
  const std::size_t each = kDetectionsReserved / std::max<std::size_t>(1, observations.size());
  for (Observation& look : observations) {
    look.detections.reserve(std::min(static_cast<std::size_t>(target_count), each));
  }
}

void StepRecord::start(Time begin, Time end, const TrackTable& tracks) {
  from = begin;
  to = end;
  before = tracks;
  received_at_start.clear();
  received_at_end.clear();
  received_labels.clear();
  has_belief_of_end = false;
  observation_count = 0;
}

bool StepRecord::holds(Time time, int source) const {
  return std::any_of(
      observations.begin(), observations.begin() + observation_count,
      [&](const Observation& look) { return look.time == time && look.source == source; });
}

Observation& StepRecord::insert(Time time, int source) {
  if (observation_count == static_cast<int>(observations.size())) {
    observations.emplace_back();
  }
  auto place = static_cast<std::size_t>(observation_count++);
  const auto is_after = [&](const Observation& look) {
    return look.time > time || (look.time == time && look.source > source);
  };
  while (place > 0 && is_after(observations[place - 1])) {
    std::swap(observations[place], observations[place - 1]);
    --place;
  }
  Observation& look = observations[place];
  look.time = time;
  look.source = source;
  look.detections.clear();
  look.counted = false;
  return look;
}

}  // namespace vantage::estimator
