#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace vantage {

/// Nanoseconds of the monotonic clock: for deadlines, ages and loop statistics; never for content.
std::int64_t monotonic_ns();

/// When a computation has to stop: at an instant of the monotonic clock, after an amount of work
/// counted in nodes, or at whichever comes first.
///
/// Under a node budget alone the computation is a pure function of its inputs. A computation that
/// was stopped by the clock after N nodes of work stops at the same place under Deadline::nodes(N),
/// provided that it asks at the same places and does at least one node of work between two askings;
/// that is what makes a flight replay bit for bit.
class Deadline {
 public:
  /// Never expires by the clock; expires once `budget_nodes` nodes are done.
  static Deadline nodes(std::int64_t budget_nodes) { return {budget_nodes, kNever}; }
  /// Expires when monotonic_ns() reaches `instant_ns`.
  static Deadline at(std::int64_t instant_ns) { return {kNever, instant_ns}; }
  /// Expires at whichever comes first.
  static Deadline either(std::int64_t budget_nodes, std::int64_t instant_ns) {
    return {budget_nodes, instant_ns};
  }
  static Deadline never() { return {kNever, kNever}; }
  /// The same, and expired as soon as `is_cancelled` says so: a person who waits no longer. Asked
  /// as often as the clock is read; must be cheap and stay true.
  [[nodiscard]] Deadline unless(bool (*is_cancelled)()) const {
    Deadline out = *this;
    out.is_cancelled_ = is_cancelled;
    return out;
  }

  /// The same budget of nodes, and a third of the time that is left now: of a computation that
  /// others follow. Reads the clock once, unless the budget is of nodes only.
  [[nodiscard]] Deadline third() const {
    Deadline out = *this;
    if (instant_ns_ != kNever) {
      const std::int64_t now_ns = monotonic_ns();
      out.instant_ns_ = std::min(instant_ns_, now_ns + (instant_ns_ - now_ns) / 3);
    }
    return out;
  }

  /// True once it is time to stop. One clock read (about 30 ns) unless the budget is of nodes only.
  [[nodiscard]] bool expired(std::int64_t nodes_done) const {
    return nodes_done >= budget_nodes_ ||
           (instant_ns_ != kNever && monotonic_ns() >= instant_ns_) ||
           (is_cancelled_ != nullptr && is_cancelled_());
  }

  [[nodiscard]] std::int64_t instant_ns() const { return instant_ns_; }
  [[nodiscard]] std::int64_t budget_nodes() const { return budget_nodes_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  Deadline(std::int64_t budget_nodes, std::int64_t instant_ns)
      : budget_nodes_(budget_nodes), instant_ns_(instant_ns) {}

  std::int64_t budget_nodes_;
  std::int64_t instant_ns_;
  bool (*is_cancelled_)() = nullptr;
};

}  // namespace vantage
