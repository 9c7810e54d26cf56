#include "tools/supervisor/restart_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vantage::tools {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

std::int64_t nanoseconds(double seconds_s) {
  return static_cast<std::int64_t>(std::llround(seconds_s * kNanosecondsPerSecond));
}

}  // namespace

void RestartSchedule::on_start(Nanoseconds now_ns) {
  if (was_started_) {
    ++restarts_;
    recent_ns_.push_back(now_ns);
  }
  was_started_ = true;
  started_ns_ = now_ns;
  down_ns_ += ended_ns_ ? now_ns - *ended_ns_ : 0;
  ended_ns_.reset();
}

std::optional<RestartSchedule::Nanoseconds> RestartSchedule::on_end(Nanoseconds now_ns,
                                                                    bool is_needed) {
  ended_ns_ = now_ns;
  if (now_ns - started_ns_ >= nanoseconds(policy_.settled_s)) {
    streak_ = 0;
  }
  const Nanoseconds window_start_ns = now_ns - nanoseconds(policy_.window_s);
  while (!recent_ns_.empty() && recent_ns_.front() <= window_start_ns) {
    recent_ns_.pop_front();
  }
  if (!is_needed && std::ssize(recent_ns_) >= policy_.restarts_max) {
    return std::nullopt;
  }
  const double backoff_s =
      std::min({std::ldexp(policy_.backoff_first_s, streak_), policy_.backoff_max_s,
                is_needed ? kNeededBackoffMaxS : policy_.backoff_max_s});
  ++streak_;
  return now_ns + nanoseconds(backoff_s);
}

double RestartSchedule::down_s(Nanoseconds now_ns) const {
  const Nanoseconds down_ns = down_ns_ + (ended_ns_ ? now_ns - *ended_ns_ : 0);
  return static_cast<double>(down_ns) / kNanosecondsPerSecond;
}

}  // namespace vantage::tools
