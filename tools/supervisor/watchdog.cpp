#include "tools/supervisor/watchdog.hpp"

#include <algorithm>

namespace vantage::tools {

void Watchdog::on_sign(const std::string& process, Time now) {
  const auto found = watched_.find(process);
  if (found != watched_.end()) {
    found->second.has_given_sign = true;
    found->second.sign = now;
    found->second.start.reset();
  }
}

void Watchdog::on_end(const std::string& process) {
  const auto found = watched_.find(process);
  if (found != watched_.end()) {
    found->second.sign.reset();
    found->second.start.reset();
  }
}

void Watchdog::on_start(const std::string& process, Time now) {
  const auto found = watched_.find(process);
  if (found != watched_.end()) {
    found->second.sign.reset();
    found->second.start = found->second.has_given_sign ? std::optional(now) : std::nullopt;
  }
}

void Watchdog::skip_pause(Time now) {
  const Duration pause = last_poll_ ? now - *last_poll_ - from_seconds(kPollS) : Duration{};
  last_poll_ = now;
  if (pause <= Duration{}) {
    return;
  }
  for (auto& [process, watched] : watched_) {
    for (std::optional<Time>* const since : {&watched.sign, &watched.start}) {
      if (*since) {
        *since = std::min(**since + pause, now);
      }
    }
  }
}

std::vector<std::string> Watchdog::overdue(Time now) {
  skip_pause(now);
  std::vector<std::string> out;
  for (auto& [process, watched] : watched_) {
    const bool is_silent = watched.sign && to_seconds(now - *watched.sign) > watched.patience_s;
    const bool has_no_first_sign = watched.start && to_seconds(now - *watched.start) > kFirstSignS;
    if (is_silent || has_no_first_sign) {
      watched.sign.reset();
      watched.start.reset();
      out.push_back(process);
    }
  }
  return out;
}

}  // namespace vantage::tools
