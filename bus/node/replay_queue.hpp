#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <utility>

#include "core/time.hpp"

namespace vantage::bus {

/// Interval at which a node that replays a log calls ReplayQueue::tick().
inline constexpr Duration kReplayTick = std::chrono::milliseconds(100);

/// Queue of the logged outputs that a replay must recompute, in their original order. The first
/// output in the queue waits for inputs that may still arrive. The wait ends when more than
/// `later_max` outputs are queued, or after two seconds of ticks. Then the output is recomputed
/// from the available inputs.
template <class Logged>
class ReplayQueue {
 public:
  explicit ReplayQueue(std::size_t later_max = 3) : later_max_(later_max) {}

  void add(const Logged& logged) { waiting_.push_back(logged); }
  /// Must be called once per kReplayTick, followed by work().
  void tick() { ticks_ = waiting_.empty() ? 0 : ticks_ + 1; }
  /// Passes the queued outputs in order to recompute(logged, is_last_chance), until it returns
  /// false because an input is missing. recompute() is then called again later with the same
  /// output, unless is_last_chance was true.
  template <class Recompute>
  void work(const Recompute& recompute) {
    while (!waiting_.empty()) {
      const bool is_last_chance = waiting_.size() > later_max_ || ticks_ >= kTicksMax;
      if (!recompute(std::as_const(waiting_.front()), is_last_chance) && !is_last_chance) {
        return;
      }
      ticks_ = 0;
      waiting_.pop_front();
    }
  }

 private:
  static constexpr int kTicksMax = 20;

  std::size_t later_max_;
  std::deque<Logged> waiting_;
  int ticks_ = 0;  ///< number of ticks that the first output has waited
};

}  // namespace vantage::bus
