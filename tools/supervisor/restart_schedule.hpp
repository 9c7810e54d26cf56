#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace vantage::tools {

/// Rules for restarting a process that has ended.
struct RestartPolicy {
  double backoff_first_s = 0.2;  ///< s; first pause; doubled after each further end
  double backoff_max_s = 5.0;
  double settled_s = 10.0;  ///< s; a run at least this long resets the back-off
  /// maximum number of restarts within window_s; after one more end the process is given up
  int restarts_max = 5;
  double window_s = 60.0;
};

/// Decides whether and when one process is restarted. Pure: the caller passes the time of any clock
/// that does not go back.
class RestartSchedule {
 public:
  using Nanoseconds = std::int64_t;
  explicit RestartSchedule(RestartPolicy policy = {}) : policy_(policy) {}

  /// Notes that the process was started, for the first time or again.
  void on_start(Nanoseconds now_ns);
  /// s; maximum back-off of a process that `is_needed`.
  static constexpr double kNeededBackoffMaxS = 1.0;
  /// Notes that the process ended or could not be started. Returns when to start it again; nullopt
  /// if it is given up permanently. A process that `is_needed`, because its vehicle may be in
  /// flight, is never given up.
  [[nodiscard]] std::optional<Nanoseconds> on_end(Nanoseconds now_ns, bool is_needed = false);

  [[nodiscard]] const RestartPolicy& policy() const { return policy_; }
  /// Returns the number of starts after the first.
  [[nodiscard]] int restarts() const { return restarts_; }
  /// Returns the time in s for which the process was not running since its first start.
  [[nodiscard]] double down_s(Nanoseconds now_ns) const;

 private:
  RestartPolicy policy_;
  bool was_started_ = false;
  int restarts_ = 0;
  int streak_ = 0;  ///< number of ends since it last ran for settled_s
  Nanoseconds started_ns_ = 0;
  std::optional<Nanoseconds> ended_ns_;  ///< last end; nullopt while the process is running
  Nanoseconds down_ns_ = 0;              ///< time not running, without the time since ended_ns_
  std::deque<Nanoseconds> recent_ns_;    ///< times of the restarts within the window
};

}  // namespace vantage::tools
