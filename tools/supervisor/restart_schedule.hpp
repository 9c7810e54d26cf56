#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace vantage::tools {

/// How a dead process is started again.
struct RestartPolicy {
  double backoff_first_s = 0.2;  ///< doubled with each death
  double backoff_max_s = 5.0;
  double settled_s = 10.0;  ///< after running for this long the next back-off is the first again
  int restarts_max = 5;     ///< within window_s; a process that dies more often is given up
  double window_s = 60.0;
};

/// Decides when one process is started again, if at all. Pure: told the time, of any clock that
/// does not go back.
class RestartSchedule {
 public:
  using Nanoseconds = std::int64_t;
  explicit RestartSchedule(RestartPolicy policy = {}) : policy_(policy) {}

  /// It was started, for the first time or again.
  void on_start(Nanoseconds now_ns);
  /// With `is_needed` the back-off is no longer.
  static constexpr double kNeededBackoffMaxS = 1.0;
  /// It ended, or could not be started. When to start it again; nullopt: it is given up
  /// permanently. One that `is_needed`, as a vehicle may be in flight, is never given up.
  [[nodiscard]] std::optional<Nanoseconds> on_end(Nanoseconds now_ns, bool is_needed = false);

  [[nodiscard]] const RestartPolicy& policy() const { return policy_; }
  /// Starts after the first.
  [[nodiscard]] int restarts() const { return restarts_; }
  /// Time since the first start in which it was not running.
  [[nodiscard]] double down_s(Nanoseconds now_ns) const;

 private:
  RestartPolicy policy_;
  bool was_started_ = false;
  int restarts_ = 0;
  int streak_ = 0;  ///< deaths since it last ran for settled_s
  Nanoseconds started_ns_ = 0;
  std::optional<Nanoseconds> ended_ns_;  ///< while it is not running
  Nanoseconds down_ns_ = 0;              ///< without the time since ended_ns_
  std::deque<Nanoseconds> recent_ns_;    ///< restarts within the window
};

}  // namespace vantage::tools
