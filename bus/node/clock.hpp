#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

#include "core/time.hpp"

namespace vantage::bus {

/// What time it is for the whole stack. Only nodes ask; what they call is handed the answer.
class Clock {
 public:
  Clock() = default;
  virtual ~Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  Clock(Clock&&) = delete;
  Clock& operator=(Clock&&) = delete;
  [[nodiscard]] virtual Time now() const = 0;
  /// True when now() follows the machine's clock, so that a time budget means something.
  [[nodiscard]] virtual bool is_real_time() const = 0;
};

/// The machine's wall clock, which may be set at any time: for what only shows or records.
class SystemClock : public Clock {
 public:
  [[nodiscard]] Time now() const override;
  [[nodiscard]] bool is_real_time() const override { return true; }
};

/// The stack's time as every process of a trial keeps it: what the wall clock said when the trial
/// began, carried on by the machine's monotonic clock, which nobody can set. It never goes back.
///
/// While the wall clock is within kFollowMax of it, it is drawn there by at most kSlewPerS, so that
/// NTP and PTP keep the hosts of a trial together. A wall clock that is farther away was set: that
/// is not followed as long as the process lives, and apart() says by how much. Processes of one
/// host keep one time, also one that is started after the wall clock was set: the first, usually
/// `vantage up`, hands what lies between its time and the monotonic clock on to its children
/// (hand_on()). Thread-safe.
class SteadyClock : public Clock {
 public:
  static constexpr Duration kFollowMax = std::chrono::milliseconds(500);
  static constexpr double kSlewPerS = 0.005;
  /// Environment variable: the stack's time less the monotonic clock's, microseconds.
  static constexpr const char* kHandedOn = "VANTAGE_CLOCK_OFFSET_US";

  using MonotonicNs = std::function<std::int64_t()>;
  using WallClock = std::function<Time()>;

  /// The machine's clocks, and what was handed on by the environment.
  /// @throws StartupError when a number that no machine's clock can differ by was handed on.
  SteadyClock();
  /// Any others, and nothing handed on.
  SteadyClock(MonotonicNs monotonic_ns, WallClock wall);

  [[nodiscard]] Time now() const override;
  [[nodiscard]] bool is_real_time() const override { return true; }
  /// The wall clock less now().
  [[nodiscard]] Duration apart() const { return wall_() - now(); }
  /// For processes that this one starts. Call before any thread.
  void hand_on() const;

 private:
  [[nodiscard]] Time monotonic() const { return Time{Duration{monotonic_ns_() / 1'000}}; }
  [[nodiscard]] Duration ahead_at(Time monotonic) const;

  MonotonicNs monotonic_ns_;
  WallClock wall_;
  mutable std::mutex mutex_;
  mutable Time compared_{};   ///< by the monotonic clock: with the wall clock
  mutable Duration ahead_{};  ///< of the monotonic clock, then
  mutable Duration draw_{};   ///< by how much ahead_ is to change from then on
};

/// Stands still until it is moved.
class VirtualClock : public Clock {
 public:
  explicit VirtualClock(Time start) : now_(start) {}
  [[nodiscard]] Time now() const override { return now_; }
  [[nodiscard]] bool is_real_time() const override { return false; }
  void set(Time now) { now_ = now; }

 private:
  Time now_;
};

}  // namespace vantage::bus
