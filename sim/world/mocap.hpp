#pragma once

#include <cstdint>
#include <random>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::sim {

/// A motion-capture system: all bodies at instants that are whole multiples of its period since
/// the epoch, with independent Gaussian noise on each coordinate and on yaw, reaching the stack a
/// fixed latency later.
class MocapCamera {
 public:
  /// @throws UsageError for a rate outside (0, 1000] Hz, a negative noise or latency.
  MocapCamera(const scenario::MocapSpec& spec, std::uint64_t seed);

  /// 1/rate to the nearest microsecond.
  [[nodiscard]] Duration period() const { return period_; }
  [[nodiscard]] Duration latency() const { return latency_; }
  /// The first instant of capture at or after `time`.
  [[nodiscard]] Time capture_at_or_after(Time time) const;
  /// What it sees of `truth`; the capture time is truth's, the frame number counts periods since
  /// the epoch.
  models::MocapFrame capture(const models::TruthFrame& truth);

 private:
  scenario::MocapSpec spec_;
  Duration period_;
  Duration latency_;
  std::mt19937_64 rng_;
};

}  // namespace vantage::sim
