#include "logs/file/log_scan.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace vantage::logs {
namespace {

/// How far apart the numbers of events of one log may lie where they stand close together. (Numbers
/// are not negative, so their differences do not overflow.)
constexpr std::int64_t kNear = 10'000;
constexpr std::size_t kSyncBytes = 4;

bool is_near(std::int64_t number, std::int64_t other) { return std::abs(other - number) <= kNear; }

}  // namespace

LogScan::LogScan(std::span<const std::uint8_t> log, Witness witness, std::size_t offset)
    : log_(log), witness_(std::move(witness)), position_(offset), end_of_last_(offset) {}

// A log inside of data comes to light when the event around it is damaged; its numbers must not be
// taken for the log's own. So the majority says what these are.
std::int64_t LogScan::usual_number(std::size_t offset) const {
  constexpr std::size_t kHeadersAhead = 64;
  const auto recent = std::min(kRecent, static_cast<std::size_t>(counts_.events));
  std::vector<std::int64_t> numbers(recent_numbers_.begin(),
                                    recent_numbers_.begin() + static_cast<std::ptrdiff_t>(recent));
  for (std::size_t at = find_sync(log_, offset);
       at < log_.size() && numbers.size() < recent + kHeadersAhead;
       at = find_sync(log_, at + kSyncBytes)) {
    if (const auto event = event_at(log_, at)) {
      numbers.push_back(event->number);
    }
  }
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

bool LogScan::swallows(const LogEvent& event, std::size_t offset, bool is_followed) const {
  const std::size_t end = offset + event.size_bytes();
  std::optional<std::int64_t> usual;
  for (std::size_t at = find_sync(log_, offset + kSyncBytes); at < end;
       at = find_sync(log_, at + kSyncBytes)) {
    const std::optional<LogEvent> inner = event_at(log_, at);
    if (!inner) {
      continue;
    }
    if (is_near(event.number, inner->number)) {
      return true;
    }
    usual = usual ? usual : usual_number(offset);
    if (!is_near(*usual, event.number) && is_near(*usual, inner->number)) {
      return true;
    }
    const std::size_t inner_end = at + inner->size_bytes();
    const std::optional<LogEvent> behind = event_at(log_, inner_end);
    if (!is_followed && inner_end > end && behind && is_near(inner->number, behind->number)) {
      return true;
    }
  }
  return false;
}

LogScan::Verdict LogScan::judge(const LogEvent& event, std::size_t offset) const {
  const std::size_t end = offset + event.size_bytes();
  const std::optional<LogEvent> follower = event_at(log_, end);
  const std::size_t last = (static_cast<std::size_t>(counts_.events) + kRecent - 1) % kRecent;
  const bool runs_on = (counts_.events == 0 || event.number == recent_numbers_[last] + 1) &&
                       follower && follower->number == event.number + 1;
  const Testimony testimony = witness_ ? witness_(event) : Testimony::kNone;
  if (testimony == Testimony::kDamaged) {
    return Verdict::kRefused;
  }
  if (testimony == Testimony::kWhole || (runs_on && end_of_last_ == offset)) {
    return Verdict::kSound;
  }
  const bool is_followed = follower || end == log_.size();
  if (swallows(event, offset, is_followed)) {
    return Verdict::kRefused;
  }
  return is_followed ? Verdict::kSound : Verdict::kDoubtful;
}

void LogScan::close_stretch(std::size_t end) {
  if (end <= end_of_last_) {
    return;
  }
  const DamagedStretch stretch{end_of_last_, end - end_of_last_, end == log_.size()};
  ++counts_.stretches;
  counts_.bytes_damaged += stretch.size_bytes;
  if (stretches_.size() < kStretchesKept) {
    stretches_.push_back(stretch);
  }
}

std::optional<PlacedEvent> LogScan::next() {
  while (position_ < log_.size()) {
    const std::optional<LogEvent> event = event_at(log_, position_);
    const Verdict verdict = event ? judge(*event, position_) : Verdict::kRefused;
    if (verdict == Verdict::kRefused) {
      counts_.refused += event ? 1 : 0;
      position_ = find_sync(log_, position_ + 1);
      continue;
    }
    close_stretch(position_);
    PlacedEvent placed{*event, position_, verdict == Verdict::kDoubtful};
    recent_numbers_[static_cast<std::size_t>(counts_.events) % kRecent] = event->number;
    ++counts_.events;
    counts_.doubtful += placed.is_doubtful ? 1 : 0;
    position_ += event->size_bytes();
    end_of_last_ = position_;
    return placed;
  }
  close_stretch(log_.size());
  end_of_last_ = log_.size();
  return std::nullopt;
}

}  // namespace vantage::logs
