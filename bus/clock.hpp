#pragma once

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

/// The machine's clock.
class SystemClock : public Clock {
 public:
  [[nodiscard]] Time now() const override;
  [[nodiscard]] bool is_real_time() const override { return true; }
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
