#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

#include "core/time.hpp"

namespace vantage::bus {

/// Source of time for the complete stack. Only nodes read a clock; they pass the time to the code
/// that they call.
class Clock {
 public:
  Clock() = default;
  virtual ~Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  Clock(Clock&&) = delete;
  Clock& operator=(Clock&&) = delete;
  [[nodiscard]] virtual Time now() const = 0;
  /// True if now() follows the machine's clock, so that time budgets are meaningful.
  [[nodiscard]] virtual bool is_real_time() const = 0;
};

/// The machine's wall clock, which can be set at any time. Only for display and records.
class SystemClock : public Clock {
 public:
  [[nodiscard]] Time now() const override;
  [[nodiscard]] bool is_real_time() const override { return true; }
};

/// The common time of all processes of a trial: the wall clock at the start of the trial, continued
/// by the machine's monotonic clock, which cannot be set. The common time never decreases.
///
/// While the wall clock is within kFollowMax of the common time, the common time is slewed towards
/// the wall clock by at most kSlewPerS. So NTP and PTP keep the hosts of a trial synchronous. A
/// larger difference means that the wall clock was set: the common time then ignores it, and
/// wall_offset() returns the difference. All processes of a host share one time, even those started
/// after the wall clock was set: the first process, usually `vantage up`, passes its offset from
/// the monotonic clock to its children (export_offset()). Thread-safe.
class SteadyClock : public Clock {
 public:
  static constexpr Duration kFollowMax = std::chrono::milliseconds(500);
  static constexpr double kSlewPerS = 0.005;
  /// Environment variable that contains the stack's time minus the monotonic clock, µs.
  static constexpr const char* kOffsetVariable = "VANTAGE_CLOCK_OFFSET_US";

  using MonotonicNs = std::function<std::int64_t()>;
  using WallClock = std::function<Time()>;

  /// Uses the machine's clocks and the offset in the environment, if there is one.
  /// @throws StartupError when that offset is out of range.
  SteadyClock();
  /// Uses the given clocks and ignores the environment.
  SteadyClock(MonotonicNs monotonic_ns, WallClock wall);

  [[nodiscard]] Time now() const override;
  [[nodiscard]] bool is_real_time() const override { return true; }
  /// Returns the wall clock minus now().
  [[nodiscard]] Duration wall_offset() const { return wall_() - now(); }
  /// Stores the offset in the environment, for child processes. Call before any thread starts.
  void export_offset() const;

 private:
  [[nodiscard]] Time monotonic() const { return Time{Duration{monotonic_ns_() / 1'000}}; }
  [[nodiscard]] Duration offset_at(Time monotonic) const;

  MonotonicNs monotonic_ns_;
  WallClock wall_;
  mutable std::mutex mutex_;
  mutable Time compared_{};    ///< monotonic time of the last comparison with the wall clock
  mutable Duration offset_{};  ///< offset from the monotonic clock at compared_
  mutable Duration slew_{};    ///< change of offset_ still to be made after compared_
};

/// Clock that only advances when it is set.
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
