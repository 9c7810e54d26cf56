#pragma once

#include <cstdint>
#include <random>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// Simulated motion-capture system. It captures all bodies at integer multiples of its period since
/// the epoch, with independent Gaussian noise on each coordinate and on yaw. Frames arrive after a
/// fixed latency.
class MocapCamera {
 public:
  /// @throws UsageError for a rate outside (0, 1000] Hz, a negative noise or latency.
  MocapCamera(const scenario::MocapSpec& spec, std::uint64_t seed);

  /// Returns 1/rate, rounded to microseconds.
  [[nodiscard]] Duration period() const { return period_; }
  [[nodiscard]] Duration latency() const { return latency_; }
  /// Returns the first instant of capture at or after `time`.
  [[nodiscard]] Time capture_at_or_after(Time time) const;
  /// Returns a noisy frame of `truth` with the same time. The frame number is the number of periods
  /// since the epoch. Draws random numbers.
  models::MocapFrame capture(const models::TruthFrame& truth);

 private:
  scenario::MocapSpec spec_;
  Duration period_;
  Duration latency_;
  std::mt19937_64 rng_;
};

}  // namespace vantage::sim
