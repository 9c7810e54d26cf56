#include "estimator/filter/step_record.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace vantage::estimator {

StepRecord::StepRecord(int detections_max, int observations_max)
    : observations(static_cast<std::size_t>(observations_max)) {
  const std::size_t each = kDetectionsReserved / std::max<std::size_t>(1, observations.size());
  for (Observation& look : observations) {
    look.detections.reserve(std::min(static_cast<std::size_t>(detections_max), each));
  }
}

void StepRecord::start(const Step& next) {
  step = next;
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
