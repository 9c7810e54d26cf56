#include "logs/file/usual_times.hpp"

#include <algorithm>
#include <utility>

namespace vantage::logs {

// Times from a log are ≥ 0, so their differences cannot overflow.
bool UsualTimes::Group::reaches(Time time) const {
  return time >= begin ? time - end < kApart : begin - time < kApart;
}

void UsualTimes::add(Time time) {
  if (groups_.empty() || !groups_.front().reaches(time)) {
    add_to_others(time);
    return;
  }
  Group& group = groups_.front();
  const bool is_within = time >= group.begin && time <= group.end;
  group.begin = std::min(group.begin, time);
  group.end = std::max(group.end, time);
  ++group.events;
  if (is_within || groups_.size() == 1) {
    return;
  }
  // The group has grown. If it reaches another group, both groups are merged.
  for (std::size_t i = groups_.size() - 1; i > 0; --i) {
    const Group& other = groups_[i];
    if (groups_.front().reaches(other.begin) || groups_.front().reaches(other.end)) {
      groups_.front().begin = std::min(groups_.front().begin, other.begin);
      groups_.front().end = std::max(groups_.front().end, other.end);
      groups_.front().events += other.events;
      groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

void UsualTimes::add_to_others(Time time) {
  const auto group = std::find_if(groups_.begin(), groups_.end(),
                                  [&](const Group& each) { return each.reaches(time); });
  if (group != groups_.end()) {
    std::iter_swap(groups_.begin(), group);
    add(time);
    return;
  }
  if (groups_.size() == kGroupsMax) {
    const auto least =
        std::min_element(groups_.begin(), groups_.end(),
                         [](const Group& a, const Group& b) { return a.events < b.events; });
    dropped_events_ += least->events;
    groups_.erase(least);
  }
  groups_.insert(groups_.begin(), {time, time, 1});
}

UsualTimes::Span UsualTimes::span() const {
  if (groups_.empty()) {
    return {};
  }
  const auto most =
      std::max_element(groups_.begin(), groups_.end(),
                       [](const Group& a, const Group& b) { return a.events < b.events; });
  const auto is_outlying = [&](const Group& group) {
    return group.events * kFewer <= most->events;
  };
  Span span{most->begin, most->end, dropped_events_};
  for (const Group& group : groups_) {
    if (!is_outlying(group)) {
      span.begin = std::min(span.begin, group.begin);
      span.end = std::max(span.end, group.end);
    }
  }
  for (const Group& group : groups_) {
    span.outlying += group.end < span.begin || group.begin > span.end ? group.events : 0;
  }
  return span;
}

}  // namespace vantage::logs
