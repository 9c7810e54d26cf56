#include "logs/file/log_scan.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "logs/file/mapped_file.hpp"

namespace vantage::logs {
namespace {

/// Largest difference between the numbers of nearby events of one log. (Numbers are ≥ 0, so their
/// differences cannot overflow.)
constexpr std::int64_t kNear = 10'000;
/// After this number of consecutive events with unusual numbers, these numbers become the usual
/// ones: the log was concatenated from several logs.
constexpr int kUnusualMax = 64;
/// Maximum number of sync words examined inside one event. It keeps the time linear for a file that
/// contains only headers.
constexpr int kInsideMax = 200;

bool is_near(std::int64_t number, std::int64_t other) { return std::abs(other - number) <= kNear; }

bool runs_on(const std::optional<LogEvent>& event, std::int64_t number) {
  return event && event->number == number + 1;
}

std::int64_t median(std::vector<std::int64_t> numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace

LogScan::LogScan(std::span<const std::uint8_t> log, DataChecker checker, std::size_t offset)
    : log_(log), checker_(std::move(checker)), position_(offset), end_of_last_(offset) {}

// Returns the median of recent and following event numbers. If an event that contains a log is
// damaged, the headers of the inner log become visible, and their numbers must not be mistaken for
// the log's own. Headers inside an event are not counted if the event's own successor follows it.
std::int64_t LogScan::usual_number(std::size_t offset) const {
  constexpr std::size_t kHeadersAhead = 64;
  constexpr std::size_t kBytesAhead = std::size_t{1}
                                      << 20U;  // farther headers would cost disk reads
  const auto ahead = log_.first(offset + std::min(kBytesAhead, log_.size() - offset));
  std::vector<std::int64_t> numbers = usual_numbers_;
  const std::size_t recent = numbers.size();
  std::size_t at = find_sync(ahead, offset);
  while (at < ahead.size() && numbers.size() < recent + kHeadersAhead) {
    const std::optional<LogEvent> event = event_at(log_, at);
    std::size_t next = at + kSyncBytes;
    if (event) {
      numbers.push_back(event->number);
      const std::size_t end = at + event->size_bytes();
      next = runs_on(event_at(log_, end), event->number) ? end : next;
    }
    at = find_sync(ahead, next);
  }
  return median(std::move(numbers));
}

void LogScan::remember(std::int64_t number) {
  last_number_ = number;
  const std::int64_t usual =
      usual_numbers_.empty() ? usual_number(position_) : median(usual_numbers_);
  const bool is_unusual = !is_near(usual, number);
  unusual_in_a_row_ = is_unusual ? unusual_in_a_row_ + 1 : 0;
  if (is_unusual && unusual_in_a_row_ < kUnusualMax) {
    return;
  }
  if (is_unusual) {
    usual_numbers_.clear();
    unusual_in_a_row_ = 0;
  } else if (usual_numbers_.size() == kRecent) {
    usual_numbers_.erase(usual_numbers_.begin());
  }
  usual_numbers_.push_back(number);
}

bool LogScan::reaches_the_end(std::size_t at) const {
  std::optional<LogEvent> event = event_at(log_, at);
  for (int links = 0; event && links < kInsideMax; ++links) {
    at += event->size_bytes();
    if (at == log_.size()) {
      return true;
    }
    const std::optional<LogEvent> next = event_at(log_, at);
    event = runs_on(next, event->number) ? next : std::nullopt;
  }
  return false;
}

bool LogScan::swallows(const LogEvent& event, std::size_t offset, bool is_followed) const {
  const std::size_t end = offset + event.size_bytes();
  std::optional<std::int64_t> usual;
  int inside = 0;
  for (std::size_t at = find_sync(log_, offset + kSyncBytes); at < end && inside < kInsideMax;
       at = find_sync(log_, at + kSyncBytes), ++inside) {
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
    if (!is_followed && inner_end > end && runs_on(event_at(log_, inner_end), inner->number) &&
        (!is_near(*usual, event.number) || reaches_the_end(at))) {
      return true;
    }
  }
  return false;
}

LogScan::Verdict LogScan::judge(const LogEvent& event, std::size_t offset) const {
  const std::size_t end = offset + event.size_bytes();
  const std::optional<LogEvent> follower = event_at(log_, end);
  const bool is_in_order =
      (counts_.events == 0 || event.number == last_number_ + 1) && runs_on(follower, event.number);
  const DataCheck check = checker_ ? checker_(event) : DataCheck::kNone;
  if (check == DataCheck::kDamaged) {
    return Verdict::kRefused;
  }
  if (check == DataCheck::kComplete || (is_in_order && end_of_last_ == offset)) {
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

std::optional<LocatedEvent> LogScan::next() {
  while (position_ < log_.size()) {
    const std::optional<LogEvent> event = event_at(log_, position_);
    const Verdict verdict = event ? judge(*event, position_) : Verdict::kRefused;
    if (verdict == Verdict::kRefused) {
      counts_.refused += event ? 1 : 0;
      position_ = find_sync(log_, position_ + 1);
      continue;
    }
    if (is_any_truncated()) {
      require_not_truncated(log_);
    }
    close_stretch(position_);
    LocatedEvent placed{*event, position_, verdict == Verdict::kDoubtful};
    remember(event->number);
    ++counts_.events;
    counts_.doubtful += placed.is_doubtful ? 1 : 0;
    position_ += event->size_bytes();
    end_of_last_ = position_;
    return placed;
  }
  require_not_truncated(log_);
  close_stretch(log_.size());
  end_of_last_ = log_.size();
  return std::nullopt;
}

}  // namespace vantage::logs
