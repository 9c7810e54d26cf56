#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <utility>

#include "core/time.hpp"

namespace vantage::bus {

/// How often a node that replays a log calls ReplayQueue::tick().
inline constexpr Duration kReplayTick = std::chrono::milliseconds(100);

/// What a log says was made and is to be made again, in its order. Each waits for inputs that may
/// still be on their way until `later_max` later ones wait behind it or it has waited two seconds
/// of ticks: then it has to do with what is there.
template <class Logged>
class ReplayQueue {
 public:
  explicit ReplayQueue(std::size_t later_max = 3) : later_max_(later_max) {}

  void add(const Logged& logged) { waiting_.push_back(logged); }
  /// Once every kReplayTick, then work().
  void tick() { ticks_ = waiting_.empty() ? 0 : ticks_ + 1; }
  /// Gives what waits to redo(logged, is_last_chance), one after another while that says true: done
  /// with it. It may say false, to be asked again, but for the last chance.
  template <class Redo>
  void work(const Redo& redo) {
    while (!waiting_.empty()) {
      const bool is_last_chance = waiting_.size() > later_max_ || ticks_ >= kTicksMax;
      if (!redo(std::as_const(waiting_.front()), is_last_chance) && !is_last_chance) {
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
  int ticks_ = 0;  ///< that the first of them has waited
};

}  // namespace vantage::bus
