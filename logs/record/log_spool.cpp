#include "logs/record/log_spool.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "logs/file/log_event.hpp"
#include "logs/record/log_tail.hpp"

namespace vantage::logs {
namespace {

/// Size of the queue at which the writer thread is woken before write_period ends.
constexpr std::size_t kWakeBytes = std::size_t{1} << 20U;
constexpr std::size_t kNumberAt = 4;  ///< offset of the number in an event
constexpr std::size_t kTimeAt = 12;   ///< offset of the time in an event
constexpr std::int64_t kNsPerUs = 1'000;

void put_big_endian(std::uint64_t value, std::span<std::uint8_t> event, std::size_t at) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    event[at + i] = static_cast<std::uint8_t>(value >> (8 * (sizeof value - 1 - i)));
  }
}

/// Returns the earlier of two instants; 0 means none.
std::int64_t earlier(std::int64_t a_ns, std::int64_t b_ns) {
  return a_ns == 0 ? b_ns : b_ns == 0 ? a_ns : std::min(a_ns, b_ns);
}

std::int64_t count_events(std::span<const std::uint8_t> events) {
  return whole_events(events, 0).events_beyond;
}

bool exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(std::filesystem::symlink_status(path, error));
}

}  // namespace

LogSpool::LogSpool(SpoolOptions options, OpenFile open)
    : options_(std::move(options)), open_(std::move(open)) {
  if (options_.existing == Existing::kAppend) {
    while (exists(path_of(path_number_ + 1))) {
      ++path_number_;
    }
  }
  report_.path = path_of(path_number_);
  if (options_.existing == Existing::kAppend) {
    report_.trimmed_bytes = trim_log(report_.path).dropped_bytes;
  }
  auto file = open_(report_.path, options_.existing);
  if (!file.ok()) {
    throw StartupError(file.error().message);
  }
  file_ = std::move(file).value();
  bytes_before_ = file_->size_bytes();
  for (int number = 1; number < path_number_; ++number) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(path_of(number), error);
    bytes_before_ += error ? 0 : bytes;
  }
  if (report_.trimmed_bytes > 0) {
    notices_.push_back(report_.path + ": " + std::to_string(report_.trimmed_bytes) +
                       " bytes of an unfinished event were removed from its end");
  }
  report_.free_bytes = file_->free_bytes();
  queued_.reserve(kWakeBytes);
  writer_ = std::thread([this] { write_loop(); });
  syncer_ = std::thread([this] { sync_loop(); });
}

LogSpool::~LogSpool() { close(); }

std::string LogSpool::path_of(int number) const {
  return number == 1 ? options_.path : numbered_path(options_.path, number);
}

bool LogSpool::write(Time time, std::string_view channel, std::span<const std::uint8_t> data) {
  const LogEvent event{0, time, channel, data};
  const std::lock_guard lock(mutex_);
  const std::size_t bytes = queued_.size() + taken_bytes_ + event.size_bytes();
  if (is_closing_ || bytes > options_.queue_bytes_max) {
    ++report_.events_lost;
    if (!is_closing_ && !std::exchange(is_overflowing_, true)) {
      notices_.push_back(report_.path + ": events are lost: the disk is slower than the bus");
    }
    return false;
  }
  if (queued_.empty()) {
    queued_since_ns_ = monotonic_ns();
  }
  append_event(event, queued_);
  if (queued_.size() >= kWakeBytes) {
    wake_writer_.notify_one();
  }
  return true;
}

std::vector<std::string> LogSpool::take_notices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notices_, {});
}

SpoolReport LogSpool::report() const {
  const std::lock_guard lock(mutex_);
  SpoolReport out = report_;
  out.queue_bytes = queued_.size() + taken_bytes_;
  // Data that are still unsynced count as well, so that a disk that hangs is reported.
  const std::int64_t since_ns = earlier(earlier(queued_since_ns_, taken_since_ns_),
                                        earlier(unsynced_since_ns_, syncing_since_ns_));
  if (since_ns != 0) {
    out.at_risk_worst_us = std::max(out.at_risk_worst_us, (monotonic_ns() - since_ns) / kNsPerUs);
  }
  return out;
}

void LogSpool::close() {
  if (!writer_.joinable()) {
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
  }
  wake_writer_.notify_one();
  writer_.join();
  {
    const std::lock_guard lock(mutex_);
    is_written_out_ = true;
  }
  wake_syncer_.notify_one();
  syncer_.join();
}

void LogSpool::write_loop() {
  std::vector<std::uint8_t> taken;
  taken.reserve(kWakeBytes);
  while (true) {
    {
      Lock lock(mutex_);
      wake_writer_.wait_for(lock, options_.write_period,
                            [&] { return is_closing_ || queued_.size() >= kWakeBytes; });
      if (queued_.empty() && is_closing_) {
        break;
      }
      taken.swap(queued_);
      taken_bytes_ = taken.size();
      taken_since_ns_ = std::exchange(queued_since_ns_, 0);
    }
    put(taken);
    taken.clear();
    const std::lock_guard lock(mutex_);
    taken_bytes_ = 0;
    taken_since_ns_ = 0;
  }
  file_.reset();
}

// Numbers the events and splits them into runs that belong to one file.
void LogSpool::put(std::span<std::uint8_t> events) {
  std::size_t run = 0;
  std::uint64_t total = bytes_before_ + report_.bytes;  // only this thread writes these values
  for (std::size_t at = 0; at < events.size();) {
    const std::size_t size = event_bytes_at(events, at);
    const std::span<std::uint8_t> event = events.subspan(at, size);
    if (options_.limit_bytes > 0 && total + size > options_.limit_bytes) {
      put_run(events.subspan(run, at - run));
      lose(count_events(events.subspan(at)));
      const std::lock_guard lock(mutex_);
      if (!std::exchange(report_.is_full, true)) {
        notices_.push_back(report_.path + ": the limit of " + std::to_string(options_.limit_bytes) +
                           " bytes is reached");
      }
      return;
    }
    const std::uint64_t file_bytes = file_ ? file_->size_bytes() + at - run : 0;
    if (options_.rotate_bytes > 0 && file_bytes > 0 && file_bytes + size > options_.rotate_bytes) {
      put_run(events.subspan(run, at - run));
      run = at;
      const auto utime = static_cast<std::int64_t>(read_big_endian(&event[kTimeAt], 8));
      if (!open_next(from_utime(utime))) {
        lose(count_events(events.subspan(at)));
        return;
      }
    }
    put_big_endian(static_cast<std::uint64_t>(next_number_++), event, kNumberAt);
    const auto channel = event_at(events, at)->channel;
    if (channel == bus::kScenario.name) {
      scenario_.assign(event.begin(), event.end());
    }
    total += size;
    at += size;
  }
  put_run(events.subspan(run));
}

void LogSpool::put_run(std::span<const std::uint8_t> events) {
  const std::uint64_t begin = file_->size_bytes();
  std::size_t done = 0;
  while (done < events.size()) {
    const auto taken = file_->append(events.subspan(done));
    if (taken.ok()) {
      done += taken.value();
      continue;
    }
    if (!wait_to_retry(taken.error())) {
      const WholeEvents whole = whole_events(events, done);
      const auto uncut = file_->cut(begin + whole.bytes);
      note_written(events.first(whole.bytes));
      lose(whole.events_beyond);
      if (uncut) {
        const std::lock_guard lock(mutex_);
        notices_.push_back(uncut->message);
      }
      return;
    }
  }
  note_written(events);
  const std::lock_guard lock(mutex_);
  is_overflowing_ = false;
  if (!events.empty() && !std::exchange(report_.is_written, true)) {
    notices_.push_back(report_.path + ": the log is written again; number of lost events: " +
                       std::to_string(report_.events_lost));
  }
}

bool LogSpool::open_next(Time time) {
  while (true) {
    while (exists(path_of(path_number_ + 1))) {
      ++path_number_;
    }
    auto file = open_(path_of(path_number_ + 1), Existing::kRefuse);
    if (file.ok()) {
      file_ = std::move(file).value();
      break;
    }
    if (!wait_to_retry(file.error())) {
      return false;
    }
  }
  ++path_number_;
  next_number_ = 0;
  {
    const std::lock_guard lock(mutex_);
    report_.path = path_of(path_number_);
    ++report_.files;
  }
  if (!scenario_.empty()) {
    put_big_endian(static_cast<std::uint64_t>(next_number_++), scenario_, kNumberAt);
    put_big_endian(static_cast<std::uint64_t>(to_utime(time)), scenario_, kTimeAt);
    put_run(scenario_);
  }
  return true;
}

// Waits for the next attempt. Returns false if the spool is closing, so that retrying ends.
bool LogSpool::wait_to_retry(const Error& error) {
  const auto free_bytes = file_->free_bytes();
  Lock lock(mutex_);
  report_.free_bytes = free_bytes;
  if (std::exchange(report_.is_written, false)) {
    ++report_.write_errors;
    notices_.push_back("LOG NOT WRITTEN: " + error.message);
  }
  return !wake_writer_.wait_for(lock, options_.retry_period, [&] { return is_closing_; });
}

void LogSpool::lose(std::int64_t events) {
  const std::lock_guard lock(mutex_);
  report_.events_lost += events;
}

void LogSpool::note_written(std::span<const std::uint8_t> events) {
  if (events.empty()) {
    return;
  }
  const std::int64_t count = count_events(events);
  const std::lock_guard lock(mutex_);
  report_.bytes += events.size();
  report_.events += count;
  if (unsynced_.empty() || unsynced_.back() != file_) {
    unsynced_.push_back(file_);
  }
  unsynced_since_ns_ = earlier(unsynced_since_ns_, taken_since_ns_);
  wake_syncer_.notify_one();
}

void LogSpool::sync_loop() {
  const std::int64_t at_risk_max_us = std::chrono::microseconds(at_risk_max(options_)).count();
  std::int64_t warned_us = at_risk_max_us;
  Lock lock(mutex_);
  while (true) {
    wake_syncer_.wait(lock, [&] { return !unsynced_.empty() || is_written_out_; });
    if (unsynced_.empty()) {
      return;
    }
    auto files = std::exchange(unsynced_, {});
    syncing_since_ns_ = std::exchange(unsynced_since_ns_, 0);
    lock.unlock();
    std::optional<Error> error;
    for (const auto& file : files) {
      auto failed = file->sync();
      error = error ? error : std::move(failed);
    }
    const auto free_bytes = files.back()->free_bytes();
    files.clear();
    lock.lock();
    const std::int64_t at_risk_us =
        (monotonic_ns() - std::exchange(syncing_since_ns_, 0)) / kNsPerUs;
    report_.at_risk_worst_us = std::max(report_.at_risk_worst_us, at_risk_us);
    report_.free_bytes = free_bytes;
    report_.syncs_late += at_risk_us > at_risk_max_us ? 1 : 0;
    if (error && report_.sync_errors++ == 0) {
      notices_.push_back("LOG NOT SAFE: " + error->message);
    }
    if (at_risk_us > warned_us) {
      warned_us = 2 * at_risk_us;
      notices_.push_back(report_.path + ": a power cut would have lost the last " +
                         std::to_string(at_risk_us / 1'000) + " ms");
    }
    wake_syncer_.wait_for(lock, options_.sync_period, [&] { return is_written_out_; });
  }
}

}  // namespace vantage::logs
