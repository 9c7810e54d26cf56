#include "logs/file/seekable_log.hpp"

#include <algorithm>

#include "core/check.hpp"
#include "logs/file/log_index.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{8} << 20U;
/// Number of bytes at the end of the file in which the last event is searched for first.
constexpr std::size_t kTailBytes = std::size_t{64} << 10U;
/// Maximum number of bytes at the end of the file in which the last event is searched for. A search
/// that finds only foreign bytes is extended up to this limit.
constexpr std::size_t kTailBytesMax = std::size_t{16} << 20U;
constexpr std::size_t kProbeBytes = std::size_t{64} << 10U;  ///< smallest range of the bisection
constexpr std::size_t kForeignBytesMax = std::size_t{8} << 20U;
/// Bytes before an instant that are searched for the newest event of each channel.
constexpr std::size_t kLookBackBytes = std::size_t{1} << 20U;
constexpr std::size_t kBlocksRead = 32;
constexpr Duration kTick{1};

bool is_earlier(const LocatedEvent& a, const LocatedEvent& b) { return a.time < b.time; }

/// Stores `event` as the newest of its channel unless a newer one is known.
void keep_newest(const LocatedEvent& event, std::map<std::string_view, LocatedEvent>& newest) {
  const auto [known, is_new] = newest.try_emplace(event.channel, event);
  if (!is_new &&
      std::pair(known->second.time, known->second.offset) < std::pair(event.time, event.offset)) {
    known->second = event;
  }
}

bool is_in(const std::vector<std::uint8_t>& bits, std::size_t block) {
  return block / 8 < bits.size() && ((unsigned{bits[block / 8]} >> (block % 8)) & 1U) != 0;
}

}  // namespace

SeekableLog::SeekableLog(const std::string& path) : file_(path) {
  if (auto known = load_index(path, bytes())) {
    survey_ = std::move(*known);
    publish(true);
  } else {
    pass_.emplace(bytes());
    bool is_more = advance(kHeadBytes);
    while (is_more && survey().channels.empty()) {
      is_more = advance(kHeadBytes);
    }
    if (is_more) {
      read_end();
    }
  }
  if (survey().channels.empty()) {
    throw StartupError(path + ": contains no events; run `vantage log check` for details");
  }
}

bool SeekableLog::advance(std::size_t bytes) {
  if (!pass_) {
    return false;
  }
  const bool is_more = pass_->advance(bytes);
  publish(!is_more);
  if (!is_more) {
    survey_ = pass_->take();
    pass_.reset();
    static_cast<void>(save_index(path(), file_.bytes(), survey_));
  }
  return is_more;
}

void SeekableLog::publish(bool is_all) {
  const LogSurvey& known = survey();
  const std::lock_guard lock(mutex_);
  const std::size_t before = blocks_.size();
  // The last block may still grow, so it is not searched before it is complete.
  const std::size_t count =
      is_all ? known.blocks.size()
             : known.blocks.size() - std::min<std::size_t>(1, known.blocks.size());
  blocks_.insert(blocks_.end(), known.blocks.begin() + static_cast<std::ptrdiff_t>(before),
                 known.blocks.begin() + static_cast<std::ptrdiff_t>(count));
  for (const auto& [name, channel] : known.channels) {
    std::vector<std::uint8_t>& bits = in_block_[name];
    bits.resize(channel.in_block.size());
    for (std::size_t i = before / 8; i < bits.size(); ++i) {
      bits[i] = channel.in_block[i];
    }
  }
  surveyed_bytes_ = is_all                 ? file_.bytes().size()
                    : known.blocks.empty() ? 0
                                           : known.blocks.back().offset;
  is_surveyed_ = is_all;
  pass_bytes_ = pass_ ? pass_->position() : 0;
  first_ = known.begin;
  last_ = is_all ? known.end : std::max(last_, known.end);
}

void SeekableLog::read_end() {
  const std::size_t size = file_.bytes().size();
  bool is_found = false;
  for (std::size_t back = kTailBytes; !is_found && back <= kTailBytesMax; back *= 4) {
    const auto event = sound_event(size - std::min(back, size));
    if (!event) {
      continue;
    }
    is_found = true;
    UsualTimes times;
    scan_from(event->offset, [&](const LocatedEvent& each) {
      times.add(each.time);
      return true;
    });
    last_ = std::max(last_, times.span().end);
  }
}

bool SeekableLog::is_surveyed() const {
  const std::lock_guard lock(mutex_);
  return is_surveyed_;
}

double SeekableLog::surveyed_share() const {
  const std::lock_guard lock(mutex_);
  return static_cast<double>(surveyed_bytes_) /
         static_cast<double>(std::max<std::size_t>(1, file_.bytes().size()));
}

std::size_t SeekableLog::bytes_read() const {
  const std::lock_guard lock(mutex_);
  return pass_bytes_ + query_bytes_;
}

std::pair<Time, Time> SeekableLog::range() const {
  const std::lock_guard lock(mutex_);
  return {first_, last_};
}

template <class Take>
void SeekableLog::scan_from(std::size_t offset, Take take) const {
  LogScan scan(file_.bytes(), check_wire_data, offset);
  for (auto event = scan.next(); event && take(*event); event = scan.next()) {
  }
  query_bytes_ += scan.position() - offset;
}

std::size_t SeekableLog::block_end(std::size_t index) const {
  return index + 1 < blocks_.size() ? blocks_[index + 1].offset : surveyed_bytes_;
}

const SeekableLog::Events& SeekableLog::read_block(std::size_t index) const {
  const auto known = std::find_if(read_.begin(), read_.end(),
                                  [&](const auto& each) { return each.first == index; });
  if (known != read_.end()) {
    read_.splice(read_.begin(), read_, known);
    return read_.front().second;
  }
  Events events;
  const std::size_t end = block_end(index);
  scan_from(blocks_[index].offset, [&](const LocatedEvent& event) {
    if (event.offset < end) {
      events.push_back(event);
    }
    return event.offset + event.size_bytes() < end;
  });
  std::stable_sort(events.begin(), events.end(), is_earlier);
  read_.emplace_front(index, std::move(events));
  if (read_.size() > kBlocksRead) {
    read_.pop_back();
  }
  return read_.front().second;
}

std::optional<LocatedEvent> SeekableLog::sound_event(std::size_t offset) const {
  const auto log = file_.bytes();
  const auto near = log.first(offset + std::min(kForeignBytesMax, log.size() - offset));
  for (std::size_t at = find_sync(near, offset); at < near.size();
       at = find_sync(near, at + kSyncBytes)) {
    const std::optional<LogEvent> event = event_at(log, at);
    const std::size_t end = event ? at + event->size_bytes() : 0;
    if (event && (end == log.size() || event_at(log, end))) {
      query_bytes_ += end - offset;
      return LocatedEvent{*event, at, false};
    }
  }
  query_bytes_ += near.size() - offset;
  return std::nullopt;
}

std::size_t SeekableLog::offset_of(Time time) const {
  std::size_t low = surveyed_bytes_;  // start of an event before `time`, if one exists
  std::size_t high = file_.bytes().size();
  while (high - low > kProbeBytes) {
    const std::size_t middle = low + (high - low) / 2;
    const auto event = sound_event(middle);
    if (event && event->offset < high && event->time < time) {
      low = event->offset;
    } else {
      high = middle;
    }
  }
  return low;
}

std::vector<LocatedEvent> SeekableLog::events(Time from, Time to) const {
  const std::lock_guard lock(mutex_);
  Events found;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].time_max < from || blocks_[i].time_min >= to) {
      continue;
    }
    for (const LocatedEvent& event : read_block(i)) {
      if (event.time >= from && event.time < to) {
        found.push_back(event);
      }
    }
  }
  if (!is_surveyed_) {
    scan_from(offset_of(from), [&](const LocatedEvent& event) {
      if (event.time >= from && event.time < to) {
        found.push_back(event);
      }
      return event.time < to;
    });
  }
  std::stable_sort(found.begin(), found.end(), is_earlier);
  return found;
}

// Visits blocks by descending time of the newest event before `time` that they may contain. Each
// channel is searched until no remaining block can contain a newer event.
void SeekableLog::add_newest_from_blocks(Time time,
                                         std::map<std::string_view, LocatedEvent>& newest) const {
  std::vector<std::pair<Time, std::size_t>> candidates;  // heap of (time, block), newest first
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].time_min < time) {
      candidates.emplace_back(std::min(blocks_[i].time_max, time - kTick), i);
    }
  }
  std::make_heap(candidates.begin(), candidates.end());
  std::vector<std::pair<std::string_view, const std::vector<std::uint8_t>*>> wanted;
  for (const auto& [name, bits] : in_block_) {
    wanted.emplace_back(name, &bits);
  }
  for (; !candidates.empty() && !wanted.empty(); candidates.pop_back()) {
    std::pop_heap(candidates.begin(), candidates.end());
    const auto [bound, block] = candidates.back();
    std::erase_if(wanted, [&, bound = bound](const auto& each) {
      const auto known = newest.find(each.first);
      return known != newest.end() && known->second.time > bound;
    });
    if (std::none_of(wanted.begin(), wanted.end(),
                     [&, block = block](const auto& each) { return is_in(*each.second, block); })) {
      continue;
    }
    for (const LocatedEvent& event : read_block(block)) {
      if (event.time < time) {
        keep_newest(event, newest);
      }
    }
  }
}

std::vector<LocatedEvent> SeekableLog::newest_before(Time time) const {
  const std::lock_guard lock(mutex_);
  std::map<std::string_view, LocatedEvent> newest;
  if (!is_surveyed_) {
    const std::size_t until = offset_of(time);
    const std::size_t from = std::max(surveyed_bytes_, until - std::min(until, kLookBackBytes));
    const auto first = sound_event(from);
    scan_from(first ? first->offset : until, [&](const LocatedEvent& event) {
      if (event.time < time) {
        keep_newest(event, newest);
      }
      return event.offset < until || event.time < time;
    });
  }
  add_newest_from_blocks(time, newest);
  Events found;
  for (const auto& [channel, event] : newest) {
    found.push_back(event);
  }
  std::sort(found.begin(), found.end(), [](const LocatedEvent& a, const LocatedEvent& b) {
    return std::pair(a.time, a.offset) < std::pair(b.time, b.offset);
  });
  return found;
}

std::optional<Time> SeekableLog::next_time(Time from) const {
  const std::lock_guard lock(mutex_);
  std::optional<Time> next;
  const auto take = [&](const LocatedEvent& event) {
    if (event.time >= from && (!next || event.time < *next)) {
      next = event.time;
    }
  };
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].time_max < from || (next && blocks_[i].time_min >= *next)) {
      continue;
    }
    const Events& events = read_block(i);
    const auto found = std::find_if(events.begin(), events.end(),
                                    [&](const auto& each) { return each.time >= from; });
    if (found != events.end()) {
      take(*found);
    }
  }
  if (!is_surveyed_) {
    scan_from(offset_of(from), [&](const LocatedEvent& event) {
      take(event);
      return event.time < from;
    });
  }
  return next;
}

}  // namespace vantage::logs
