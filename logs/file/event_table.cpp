#include "logs/file/event_table.hpp"

#include <algorithm>

#include "core/check.hpp"

namespace vantage::logs {

EventTable::EventTable(const IndexedLog& log) : log_(log) {
  LogScan scan = log.scan();
  entries_.reserve(static_cast<std::size_t>(log.survey().scan.events));
  while (const auto event = scan.next()) {
    entries_.push_back({event->time, event->offset});
  }
  if (entries_.empty()) {
    throw StartupError(log.path() + ": no event of an LCM log in it");
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.time < b.time; });
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const std::string_view channel = read(i).channel;
    auto known = by_channel_.find(channel);
    if (known == by_channel_.end()) {
      known = by_channel_.emplace(channel, std::vector<std::size_t>()).first;
    }
    known->second.push_back(i);
  }
}

std::size_t EventTable::first_at(Time time) const {
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), time,
                       [](const Entry& entry, Time instant) { return entry.time < instant; });
  return static_cast<std::size_t>(found - entries_.begin());
}

std::vector<std::size_t> EventTable::newest_before(std::size_t index) const {
  std::vector<std::size_t> newest;
  for (const auto& [channel, events] : by_channel_) {
    const auto after = std::lower_bound(events.begin(), events.end(), index);
    if (after != events.begin()) {
      newest.push_back(*(after - 1));
    }
  }
  std::sort(newest.begin(), newest.end());
  return newest;
}

LogEvent EventTable::read(std::size_t index) const {
  return event_at(log_.bytes(), entries_[index].offset).value_or(LogEvent{});
}

}  // namespace vantage::logs
